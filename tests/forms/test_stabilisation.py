"""Element length, τ and terms of the stabilisation against dense matrices of single cells."""

from __future__ import annotations

import math

from mpi4py import MPI

import basix.ufl
import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

from castx.forms import stabilisation

pytestmark = pytest.mark.serial


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


CORNERS = {
    2: np.array([[0.1, 0.2], [1.3, 0.1], [0.4, 0.9]]),
    3: np.array([[0.1, 0.2, 0.0], [1.3, 0.1, 0.2], [0.4, 0.9, -0.1], [0.3, 0.2, 0.8]]),
}
TAU = 0.3


class Simplex:
    """One cell: volume and gradients of its shape functions by numpy, and its forms assembled."""

    def __init__(self, dimension: int) -> None:
        shape = "triangle" if dimension == 2 else "tetrahedron"
        element = basix.ufl.element("Lagrange", shape, 1, shape=(dimension,))
        corners = CORNERS[dimension]
        cells = np.arange(dimension + 1, dtype=np.int64)[None]
        self.domain = mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=corners, e=element)
        self.scalars = fem.functionspace(self.domain, ("Lagrange", 1))
        self.vectors = fem.functionspace(self.domain, ("Lagrange", 1, (dimension,)))
        points = self.scalars.tabulate_dof_coordinates()[:, :dimension]
        edges = points[1:] - points[0]
        self.volume = abs(np.linalg.det(edges)) / math.factorial(dimension)
        inner = np.linalg.inv(edges)
        self.gradients = np.vstack((-inner.sum(axis=1), inner.T))
        self.tau = fem.Constant(self.domain, np.float64(TAU))
        self.dx = ufl.dx(self.domain, metadata={"quadrature_degree": 2})

    def matrix(self, form) -> np.ndarray:
        return fem.assemble_matrix(fem.form(form)).to_dense()


@pytest.mark.parametrize("dimension", [2, 3])
def test_laplacian_of_one_cell(dimension):
    cell = Simplex(dimension)
    p, q = ufl.TrialFunction(cell.scalars), ufl.TestFunction(cell.scalars)
    found = cell.matrix(stabilisation.pressure_laplacian(p, q, cell.tau, cell.dx))
    expected = TAU * cell.volume * cell.gradients @ cell.gradients.T
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_body_force_of_one_cell(dimension):
    cell, b = Simplex(dimension), np.array([2.0, -5.0, 3.0])[:dimension]
    force = fem.Constant(cell.domain, b)
    q = ufl.TestFunction(cell.scalars)
    form = stabilisation.body_force_residual(q, force, cell.tau, cell.dx)
    found = fem.assemble_vector(fem.form(form)).array
    np.testing.assert_allclose(found, TAU * cell.volume * cell.gradients @ b, rtol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
def test_gradient_and_weights_of_one_cell(dimension):
    """Each corner stands for an equal part of the cell."""
    cell = Simplex(dimension)
    p, omega = fem.Function(cell.scalars), ufl.TestFunction(cell.vectors)
    p.x.array[:] = np.arange(dimension + 1.0) ** 2
    form = stabilisation.weighted_gradient(p, omega, cell.tau, cell.dx)
    found = fem.assemble_vector(fem.form(form)).array.reshape(-1, dimension)
    part = TAU * cell.volume / (dimension + 1)
    expected = np.tile(part * p.x.array @ cell.gradients, (dimension + 1, 1))
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    q = ufl.TestFunction(cell.scalars)
    form = stabilisation.projection_weight(q, cell.tau, cell.dx)
    np.testing.assert_allclose(fem.assemble_vector(fem.form(form)).array, part, rtol=1e-12)
