"""Flow in the continuity rows of a slab whose melt has an even gradient of pressure."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.domain.measures import cell_measure
from castx.mechanics.melt_flow import MeltFlow
from tests.castx.mechanics.lone_bodies import LENGTH, WIDTH, alone, random_field

pytestmark = pytest.mark.sampled

TAU = 2e-9


def flow(comm, kind: str, full: float = 1.0):
    """Return a slab and the flow in it, with a stabilisation that exceeds it by a half."""
    part = alone(comm)
    cells = part.material.compressibility.function_space
    dx = cell_measure(part.mesh, part.model, 2)
    found = MeltFlow(part.unknowns, cells, 1.5 * TAU, part.loads.body_force, kind, (), dx)
    number = len(part.cell_nodes)
    found.begin(np.full(number, TAU), np.full(number, full))
    return part, found


@pytest.mark.ranks
@pytest.mark.parametrize("kind", ["osgs", "gls"])
def test_flow_through_the_ends_of_a_slab(comm, kind):
    """τ_D ∇p times the width arrives at one end and leaves the other; nothing stays between."""
    part, found = flow(comm, kind)
    x = part.mesh.points[:, 0]
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, -1] = 1e5 * x / LENGTH / part.unknowns.pressure_scale
    drained = found.drained(part.formulation.forms)
    own = x[: len(drained)]
    ends = [comm.allreduce(float(drained[np.isclose(own, at)].sum()), MPI.SUM) for at in
            (0.0, LENGTH)]  # fmt: skip
    through = TAU * 1e5 / LENGTH * WIDTH
    np.testing.assert_allclose(ends, [-through, through], rtol=1e-12)
    inside = ~np.isclose(own, 0.0) & ~np.isclose(own, LENGTH)
    assert np.abs(drained[inside]).max(initial=0.0) < 1e-12 * through
    arriving = found.arriving(part.formulation.forms)
    factor = {"osgs": 1.0, "gls": 1.5}[kind]  # OSGS leaves an even gradient alone
    np.testing.assert_allclose(arriving, factor * drained, atol=1e-10 * through)


@pytest.mark.ranks
def test_emptied_cells_have_no_stabilisation(comm):
    part, found = flow(comm, "gls", full=0.0)
    part.solution.x.array[:] = random_field(part, 0.4)
    forms = part.formulation.forms
    np.testing.assert_allclose(found.arriving(forms), found.drained(forms), rtol=1e-12)


@pytest.mark.ranks
def test_conductance_is_the_diagonal_of_the_flow(comm):
    """A change of the pressure of one node by itself drives it, without OSGS's part."""
    part, found = flow(comm, "gls")
    owned = len(found.conductance)
    total = comm.allreduce(float(found.conductance.sum()), MPI.SUM)
    before, sums = found.arriving(part.formulation.forms), 0.0
    for node in range(comm.allreduce(owned, MPI.MAX)):
        part.solution.x.array[:] = 0.0
        row = node * part.block_size + part.block_size - 1
        if comm.rank == 0 and node < owned:
            part.solution.x.array[row] = 1.0 / part.unknowns.pressure_scale
        part.solution.x.scatter_forward()
        after = found.arriving(part.formulation.forms)
        if comm.rank == 0 and node < owned:
            sums += float((after - before)[node])
    if comm.size == 1:
        assert sums == pytest.approx(total, rel=1e-9)
    elif comm.rank == 0:
        assert sums == pytest.approx(float(found.conductance.sum()), rel=1e-9)
