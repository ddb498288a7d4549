from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

from castx.forms import heat
from castx.forms.kinematics import weight


def total(comm, form) -> float:
    return comm.allreduce(fem.assemble_scalar(fem.form(form)))


@pytest.fixture
def ring(comm):
    """Return the section 1 ≤ r ≤ 2, 0 ≤ z ≤ 1."""
    return mesh.create_rectangle(comm, [[1.0, 0.0], [2.0, 1.0]], [4, 3])


def test_heat_through_a_ring(comm, ring):
    """θ = r conducts 2πr per height: ∫∇θ·∇v with v = r is ∫2πr dr."""
    radius = fem.Function(fem.functionspace(ring, ("Lagrange", 1)))
    radius.interpolate(lambda x: x[0])
    r = weight("axisymmetric", ufl.SpatialCoordinate(ring))
    assert total(comm, heat.conduction(radius, radius, r, ufl.dx)) == pytest.approx(3 * np.pi)


def test_uniform_potential_conducts_nothing(comm, ring):
    space = fem.functionspace(ring, ("Lagrange", 1))
    one = fem.Function(space)
    one.x.array[:] = 7.0
    form = heat.conduction(one, ufl.TestFunction(space), ufl.as_ufl(1.0), ufl.dx)
    assert fem.assemble_vector(fem.form(form)).array == pytest.approx(0.0, abs=1e-12)
