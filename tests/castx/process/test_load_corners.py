"""Steps land where loads turn: a peak between two of them would not be there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from castx.case.case import Case
from castx.case.reading.read import read_case
from castx.case.stages import Schedule
from castx.process.building import step_settings
from castx.process.load_corners import load_corners, stops_of
from tests.coupled_cases import merged, states

PULSE = [[0, 0], [40, 0], [40.5, 100e6], [41, 0]]
BAR: dict[str, Any] = {
    "geometry": {"generator": "slab", "model": "plane-stress", "length": 0.04, "width": 0.02,
                 "size": 0.01},
    "materials": {"m": {
        "young_modulus": 70e9, "poisson_ratio": 0.3, "expansion": 2e-5, "density": 2700,
        "heat_capacity": 1000, "conductivity": 100, "yield_stress": 60e6, "hardening": 2e9,
    }},
    "bodies": [{"name": "casting", "material": "m", "temperature": 20,
                "law": "thermo-elasto-plastic"}],
    "boundaries": [
        {"on": "casting/wall", "displacement": {"normal": 0}},
        {"on": "casting/bottom", "displacement": {"normal": 0}},
        {"on": "casting/far", "pressure": PULSE},
    ],
    "time": {"end": 100},
}  # fmt: skip


def case(*changes: dict[str, Any]) -> Case:
    data = BAR
    for change in changes:
        data = merged(data, change)
    return read_case(data, Path("case.toml"))


def corners(*changes: dict[str, Any]) -> tuple[float, ...]:
    read = case(*changes)
    return load_corners(read, Schedule(read.stages, read.time.end))


def on_far(**conditions: Any) -> dict[str, Any]:
    return {"boundaries": [*BAR["boundaries"][:2], {"on": "casting/far", **conditions}]}


def test_a_pulse_between_two_steps_acts(comm):
    """(100 − 60) MPa over a hardening of 2 GPa are 2 % of plastic strain."""
    times = []
    for state in states(comm, BAR):
        times.append(state.time)
        assert state.problem.mechanics is not None
    strain = state.problem.mechanics.bodies["casting"].material.history.equivalent
    np.testing.assert_allclose(strain, 40e6 / 2e9, rtol=1e-3)
    assert {40.0, 40.5, 41.0} <= set(times) and len(times) < 60


@pytest.mark.serial
@pytest.mark.parametrize(
    "conditions, expected",
    [
        ({"pressure": 1e6}, ()),
        ({"pressure": PULSE}, (40.0, 40.5, 41.0)),
        ({"traction": [0.0, [[0, 0], [30, 1e6], [60, 0]]]}, (30.0, 60.0)),
        ({"displacement": {"normal": [[0, 0], [50, 1e-4], [120, 0]]}}, (50.0,)),
        ({"clamp": {"force": [[0, 10.0], [20, 30.0], [70, 10.0]]}}, (20.0, 70.0)),
        ({"pressure": {"along": ["y", "t"], "table": [
            [0, 0, 0], [0, 5, 0], [0, 9, 0], [0.02, 0, 0], [0.02, 5, 1e6], [0.02, 9, 0],
        ]}}, (5.0, 9.0)),
    ],
)  # fmt: skip
def test_every_load_has_its_corners(conditions, expected):
    assert corners(on_far(**conditions)) == expected


@pytest.mark.serial
def test_given_temperatures_have_corners():
    body = {"name": "casting", "material": "m", "law": "thermo-elasto-plastic",
            "temperature_history": [[0, 20], [10, 300], [70, 100]]}  # fmt: skip
    given = {"bodies": [body], "coupling": {"scheme": "mechanical"}}
    assert corners(given, on_far(pressure=1e6)) == (10.0, 70.0)


@pytest.mark.serial
def test_loads_of_a_stage_turn_in_each_of_its_cycles():
    far = {"on": "casting/far", "pressure": [[0, 0], [30, 0], [35, 1e6], [36, 0]]}
    stages = [{"at": 32, "boundaries": [far]}, {"at": 50, "repeat": 2}]
    assert corners(on_far(pressure=0.5e6), {"stages": stages}) == (35.0, 36.0, 85.0, 86.0)


@pytest.mark.serial
def test_a_given_step_is_not_cut():
    assert step_settings(case()).stops == (40.0, 40.5, 41.0)
    assert step_settings(case({"time": {"fixed_step": 3.0}})).stops == ()


@pytest.mark.serial
def test_what_jumps_within_the_smallest_step_does_so_in_one():
    assert stops_of((10.0,), (4.0, 4.001, 9.999, 10.0), 0.01) == (4.001, 10.0)
    assert stops_of((4.0,), (4.001,), 0.01) == (4.0, 4.001)
