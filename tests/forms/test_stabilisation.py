"""Element length and τ of the stabilisation."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

from castx.forms import stabilisation


@pytest.mark.parametrize("dimension", [2, 3])
def test_length_is_the_edge_of_a_right_angled_simplex(dimension):
    create = {2: mesh.create_unit_square, 3: mesh.create_unit_cube}[dimension]
    domain = create(MPI.COMM_SELF, *(4,) * dimension)
    length = stabilisation.element_length(domain, dimension)
    mean = fem.assemble_scalar(fem.form(length * ufl.dx(domain)))
    assert mean == pytest.approx(0.25, rel=1e-12)


def test_tau_falls_with_the_shear_modulus_and_grows_with_the_square_of_the_length():
    assert stabilisation.tau(3.0, 0.2, 0.5) == pytest.approx(0.5 * 0.04 / 6)


def test_projection_of_a_constant_gradient_leaves_nothing():
    """Σ_e τ ∫ ∇q·(∇p - Π) vanishes for a linear p, however τ jumps."""
    domain = mesh.create_unit_square(MPI.COMM_SELF, 3, 3)
    cells = fem.Function(fem.functionspace(domain, ("DG", 0)))
    cells.x.array[:] = 10.0 ** (np.arange(len(cells.x.array)) % 5)
    scalars = fem.functionspace(domain, ("Lagrange", 1))
    vectors = fem.functionspace(domain, ("Lagrange", 1, (2,)))
    p, q, omega = fem.Function(scalars), ufl.TestFunction(scalars), ufl.TestFunction(vectors)
    p.interpolate(lambda x: 3 * x[0] - 2 * x[1])
    dx = ufl.dx(domain, metadata={"quadrature_degree": 2})
    gradient = fem.assemble_vector(
        fem.form(stabilisation.weighted_gradient(p, omega, cells, dx))
    ).array.reshape(-1, 2)
    weight = fem.assemble_vector(
        fem.form(stabilisation.projection_weight(q, cells, dx))
    ).array
    np.testing.assert_allclose(gradient / weight[:, None], [[3.0, -2.0]] * len(weight), rtol=1e-12)
    projected = fem.Function(vectors)
    projected.x.array[:] = (gradient / weight[:, None]).ravel()
    rest = stabilisation.pressure_laplacian(p, q, cells, dx) - stabilisation.body_force_residual(
        q, projected, cells, dx
    )
    assert np.abs(fem.assemble_vector(fem.form(rest)).array).max() < 1e-9
