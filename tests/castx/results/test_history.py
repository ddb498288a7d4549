"""history.csv keeps the order of its columns: counters, bodies, interfaces, the whole run."""

import pytest

from castx.results.files.series import read_series
from castx.results.history import History, ordered_totals
from castx.solvers.counters import StepCounters
from tests.castx.fakes import FakeSnapshot


def test_columns_come_by_body_interface_and_run():
    names = [
        "support_force",
        "energy_error",
        "casting/mould.force.z",
        "casting/mould.force.r",
        "casting/mould.max_gap",
        "casting/mould.heat",
        "mould.heat_in",
        "mould.enthalpy",
        "casting.force_error",
        "casting.heat_in",
        "casting.solid_fraction",
    ]
    assert ordered_totals(names, ["casting", "mould"], ["casting/mould"]) == [
        "casting.solid_fraction",
        "casting.heat_in",
        "casting.force_error",
        "mould.enthalpy",
        "mould.heat_in",
        "casting/mould.heat",
        "casting/mould.max_gap",
        "casting/mould.force.r",
        "casting/mould.force.z",
        "energy_error",
        "support_force",
    ]


@pytest.mark.serial
def test_one_line_per_step_with_all_digits(tmp_path):
    history = History(tmp_path / "history.csv", ["casting"], [])
    counters = StepCounters(step=0.1, wall=1.5, heat_iterations=3, passes=2, cutbacks=1)
    for step in range(2):
        totals = {"energy_error": 1e-9 / 3.0, "casting.enthalpy": 1e5 * step}
        history.append(FakeSnapshot(0.1 * step, step, None, counters=counters, totals=totals))
    history.close()
    series = read_series(tmp_path / "history.csv")
    assert list(series) == [
        *("time", "step", "heat_iterations", "mechanics_iterations", "linear_iterations"),
        *("contact_changes", "passes"),
        *("cutbacks", "repeats", "wall", "frozen_pairs", "unbalanced", "fallbacks"),
        *("casting.enthalpy", "energy_error"),
    ]
    assert series["energy_error"].tolist() == [1e-9 / 3.0] * 2
    assert series["passes"].tolist() == [2.0, 2.0] and series["cutbacks"].tolist() == [1.0, 1.0]
    assert series["casting.enthalpy"].tolist() == [0.0, 1e5]
