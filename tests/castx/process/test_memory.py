"""Memory of a long coupled run: PETSc objects are made once or freed."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.process.simulation import Simulation
from tests.coupled_cases import cylinder

pytestmark = pytest.mark.serial

PAGE = 4096
WARM, STEPS = 60, 260


def resident_megabytes() -> float:
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE / 1e6


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("method", "linear"),
    [("condensed", "direct"), ("condensed", "iterative"), ("multipliers", "iterative")],
)
def test_memory_does_not_grow(method, linear, comm) -> None:
    changes = {
        "time": {"end": 0.02 * STEPS, "fixed_step": 0.02, "heat_substeps": 1},
        "solver": {"linear": linear},
    }
    simulation = Simulation.from_case(
        read_case(cylinder(changes, method=method), Path("case.toml")), comm
    )
    sizes = {state.step: resident_megabytes() for state in simulation}
    simulation.destroy()
    # One matrix of the bodies, leaked at each step, would be 200 times 0.1 MB.
    assert sizes[STEPS] - sizes[WARM] < 1.0
