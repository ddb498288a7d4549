"""What readers of results ask for is what a simulation hands out, and what tests put in its place.

The type checker holds the signatures; here stands that nothing is forgotten.
"""

from __future__ import annotations

import pytest

from castx.process.state import State
from castx.results.states.snapshot import FULLY_SOLID, ProcessState, Snapshot
from tests.castx.fakes import FakeSnapshot
from tests.coupled_cases import cylinder, simulation

pytestmark = pytest.mark.serial


def members(snapshot: type) -> set[str]:
    own = {name for name in vars(snapshot) if not name.startswith("_")}
    return own | set(getattr(snapshot, "__annotations__", {}))


@pytest.mark.parametrize("provider", [State, FakeSnapshot])
def test_providers_have_all_that_readers_ask_for(provider):
    assert not members(Snapshot) - members(provider)


def test_the_first_snapshot_of_a_run_is_its_initial_state(comm):
    run = simulation(comm, cylinder({"coupling": {"scheme": "thermal"}}, size=0.01))
    first = next(iter(run))
    assert (first.time, first.step, first.counters.step) == (0.0, 0, 0.0)
    assert first.process == ProcessState() and not first.process.staged
    assert first.totals["casting.solid_fraction"] < FULLY_SOLID
    assert first.totals["mould.solid_fraction"] >= FULLY_SOLID
    run.destroy()
