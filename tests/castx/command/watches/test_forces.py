"""Steps whose forces do not balance: said at the first one, and counted at the end."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.command.watches.forces import ForceWatch
from tests.castx.case_data import cylinder
from tests.castx.fakes import FakeSnapshot, cylinder_mesh

LISTENED = "castx.command.watches.forces"


def watch(comm, *errors: dict[str, float], tolerance: float = 1e-3) -> None:
    """Follow a run whose steps have these force errors; the first is that of the start."""
    case = read_case(cylinder(solver__mechanics_tolerance=tolerance), Path("case.toml"))
    mesh = cylinder_mesh(comm)
    with ForceWatch(case, comm) as forces:
        for step, found in enumerate(errors):
            totals = {f"{body}.force_error": value for body, value in found.items()}
            forces.check(FakeSnapshot(time=float(step), step=step, mesh=mesh, totals=totals))


@pytest.mark.ranks
def test_forces_that_do_not_balance_are_said_once_and_at_the_end(comm, heard):
    small, large = {"casting": 9e-4, "mould": 0.0}, {"casting": 2e-3, "mould": 0.5}
    watch(comm, large, small, {"casting": 2e-3, "mould": 1e-3}, large, small)
    if comm.rank > 0:
        assert heard == []
        return
    first, last = heard
    assert first.startswith("0.002 of the forces on casting at t = 2 s are missing, 0.001 is")
    assert last.startswith("in 2 of 4 steps")
    assert last.endswith("worst: 0.5 of the forces on mould at t = 3 s")


@pytest.mark.ranks
def test_what_was_asked_decides(comm, heard):
    watch(comm, {}, {"casting": 2e-3}, tolerance=1e-2)
    watch(comm, {}, {}, {})
    assert heard == []
    watch(comm, {}, {"casting": 2e-5}, tolerance=1e-5)
    assert len(heard) == 2 * (comm.rank == 0)
