"""history.csv keeps the order of its columns; series survive being cut off."""

import numpy as np
import pytest

from castx.results.files.series import Series, cut_back, read_series
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
        "casting.heat_in",
        "casting.solid_fraction",
    ]
    assert ordered_totals(names, ["casting", "mould"], ["casting/mould"]) == [
        "casting.solid_fraction",
        "casting.heat_in",
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
        *("time", "step", "heat_iterations", "mechanics_iterations", "contact_changes", "passes"),
        *("cutbacks", "wall", "frozen_pairs", "unbalanced", "fallbacks"),
        *("casting.enthalpy", "energy_error"),
    ]
    assert series["energy_error"].tolist() == [1e-9 / 3.0] * 2
    assert series["passes"].tolist() == [2.0, 2.0] and series["cutbacks"].tolist() == [1.0, 1.0]
    assert series["casting.enthalpy"].tolist() == [0.0, 1e5]


@pytest.mark.serial
def test_lines_are_on_disk_at_once_and_a_cut_line_is_left_out(tmp_path):
    with Series(tmp_path / "s.csv", ["time", "a.b"]) as series:
        series.append([0.0, 1.0])
        series.append([1.0, float("nan")])
        text = (tmp_path / "s.csv").read_text()
    (tmp_path / "cut.csv").write_text(text + "2.0")
    read = read_series(tmp_path / "cut.csv")
    np.testing.assert_array_equal(read["time"], [0.0, 1.0])
    np.testing.assert_array_equal(read["a.b"], [1.0, np.nan])


@pytest.mark.serial
def test_a_line_of_the_wrong_length_is_an_error(tmp_path):
    with Series(tmp_path / "s.csv", ["time"]) as series:
        with pytest.raises(ValueError, match="1 columns"):
            series.append([0.0, 1.0])


@pytest.mark.serial
def test_a_series_is_cut_back_and_goes_on_with_other_columns(tmp_path):
    path = tmp_path / "s.csv"
    with Series(path, ["time", "a", "b"]) as series:
        for k in range(4):
            series.append([0.1 * k, 1.0 / 3.0, float(k)])
    path.write_text(path.read_text() + "0.4,0.3")
    whole = path.read_text().splitlines(keepends=True)
    cut_back(path, 2)
    assert path.read_text() == "".join(whole[:3])
    with Series(path, ["time", "a", "b"], resumed=True) as series:
        series.append([0.2, 1.0 / 3.0, 2.0])
    assert path.read_text() == "".join(whole[:3]) + "0.2,0.3333333333333333,2.0\n"
    with Series(path, ["time", "b", "c"], resumed=True) as series:
        series.append([0.3, 3.0, 7.0])
    read = read_series(path)
    np.testing.assert_array_equal(read["b"], [0.0, 1.0, 2.0, 3.0])
    np.testing.assert_array_equal(read["c"], [np.nan, np.nan, np.nan, 7.0])
    cut_back(tmp_path / "none.csv", 3)
    with Series(tmp_path / "none.csv", ["time"], resumed=True) as series:
        series.append([1.0])
    assert read_series(tmp_path / "none.csv")["time"].tolist() == [1.0]
