"""Flow of Darcy's law and the stabilisation that is left beside it, on a unit square."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem, mesh

from castx.forms import mush

pytestmark = pytest.mark.serial


def test_flow_of_a_linear_pressure():
    """Weighed with a linear q it is τ_D ∇q·(∇p + b); melt that rests does not flow."""
    domain = mesh.create_unit_square(MPI.COMM_SELF, 3, 3)
    nodes = fem.functionspace(domain, ("Lagrange", 1))
    p, q = fem.Function(nodes), fem.Function(nodes)
    p.interpolate(lambda x: 3.0 * x[0] + 4.0 * x[1])
    q.interpolate(lambda x: 2.0 * x[0] - x[1])
    tau, dx = fem.Constant(domain, 0.5), ufl.dx(domain)
    force = fem.Constant(domain, np.array([-3.0, 1.0]))
    flow = fem.assemble_scalar(fem.form(mush.darcy_flow(p, q, force, tau, dx)))
    assert flow == pytest.approx(0.5 * (2.0 * 0.0 - 1.0 * 5.0))
    force.value = [-3.0, -4.0]
    rests = fem.form(mush.darcy_flow(p, ufl.TestFunction(nodes), force, tau, dx))
    assert np.abs(fem.assemble_vector(rests).array).max() < 1e-14


def test_excess_of_the_stabilisation():
    domain = mesh.create_unit_square(MPI.COMM_SELF, 1, 1)
    cells = fem.Function(fem.functionspace(domain, ("DG", 0)))
    cells.x.array[:] = [1.0, 5.0]
    excess = mush.excess(3.0, cells) * ufl.dx(domain)
    assert fem.assemble_scalar(fem.form(excess)) == pytest.approx(0.5 * 2.0)
