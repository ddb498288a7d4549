"""A gap that opens reheats the casting, which closes it again: steps of 5 s still converge.

Taken one after the other, heat and mechanics then run in a two-cycle between an open and a closed
interface. With Aitken's factor on the resistances each step takes eight passes at most, as
history.csv counts them, and finds the state at which both agree.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.errors import ConvergenceError
from castx.proof.verification.coupled.expanding_bars import Bars
from tests.coupled_cases import cylinder, merged, simulation
from tests.verification.test_v19_bars import case

pytestmark = pytest.mark.sampled

MOST_PASSES = 8
STEP = 5.0

# A long hot bar that shrinks more than the gap when it touches a cold one.
FEEDBACK = Bars(lengths=(0.1, 0.05), conductivity=(200.0, 50.0), expansion=(2.3e-5, 1e-6),
                ends=(500.0, 20.0), gap=1e-3, closed=1e5, resistance=1e-5)  # fmt: skip


def bars(given: Bars) -> dict:
    data = case(given, "plane-strain", "displacement", "condensed", 0.005)
    return merged(
        data,
        {
            "materials": {name: {"density": 2700.0} for name in ("casting", "mould")},
            "time": {"end": 100.0, "fixed_step": STEP, "first_step": STEP,
                     "smallest_step": STEP, "heat_substeps": 1},
            "coupling": {"tolerance": 1e-3},
        },
    )  # fmt: skip


def throttled(closed: float) -> dict:
    """Return the cylinder of V20 with so good a contact that any gap throttles it."""
    data = cylinder({"time": {"end": 60.0, "fixed_step": STEP}})
    data["interfaces"][0]["heat"]["closed"] = closed
    return data


@pytest.mark.parametrize(
    "data",
    [
        bars(FEEDBACK),
        bars(replace(FEEDBACK, law="series")),
        bars(replace(FEEDBACK, emissivities=(0.5, 0.8), slope=20.0)),
        throttled(1e4),
        throttled(3e4),
    ],
    ids=["limited", "series", "radiation and h(T)", "cylinder 1e4", "cylinder 3e4"],
)
def test_passes(comm, data):
    steps, passes, gaps = [], [], []
    for state in simulation(comm, data):
        steps.append(state.counters.step)
        passes.append(state.counters.passes)
        gaps.append(state.totals["casting/mould.max_gap"])
        assert state.counters.cutbacks == 0
        assert state.totals["energy_error"] < 1e-6
    assert set(np.round(steps[1:], 6)) == {STEP}
    assert max(passes) <= MOST_PASSES
    assert max(gaps) > 10e-6


@pytest.mark.serial
def test_without_acceleration_it_fails(comm, monkeypatch):
    """Quasi-Newton steps alone lead to the end too."""
    monkeypatch.setattr("castx.coupling.relaxation.AITKEN_BOUNDS", (1.0, 1.0))
    assert list(simulation(comm, bars(FEEDBACK)))[-1].time == 100.0
    monkeypatch.setattr("castx.coupling.relaxation.ALONE", 40)
    with pytest.raises(ConvergenceError, match="no longer came closer to each other in 12 passes"):
        list(simulation(comm, bars(FEEDBACK)))
