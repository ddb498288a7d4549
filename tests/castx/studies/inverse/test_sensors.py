"""Sensors: samples within the run, and curves at any depth and clock."""

import numpy as np
import pytest

from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.studies.asked.identify import Identify
from castx.studies.inverse import sensors as module
from castx.studies.inverse.sensors import Sensors
from tests.castx.cooled_mould import END, TIME, case_text, formula, measured, temperature

pytestmark = pytest.mark.serial

CURVE = {"of": "near.temperature", "file": "near.csv", "noise": "1 K"}
UNKNOWN = {"of": "interfaces.0.heat.closed", "name": "h"}


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(case_text())
    (tmp_path / "near.csv").write_text(measured(1400.0, 2e-3, 0.0))
    return load_case(path)


def sensors(case, *, study=None, **curve):
    asked = Identify.read({"curves": [{**CURVE, **curve}], "unknowns": [UNKNOWN], **(study or {})})
    return Sensors.of(asked.relative_to(case.path.parent), case)


def test_depth_and_clock_are_those_of_the_formula(case):
    found = sensors(case, depth_deviation="0.3 mm", study={"clock_deviation": "0.5 s"})
    content = case.content
    content["probes"] = found.probes(content["probes"])
    assert len(content["probes"]) == 1 + 19
    load_case(content)  # the case takes them
    columns = {name: np.array(values) for name, values in formula(content)[1].items()}
    for shift, clock in ((0.0, 0.0), (2.5e-4, 0.3), (-6e-4, -0.7)):
        values = {"depth of near": shift, "clock": clock}
        exact = temperature(np.full(len(TIME), 2000.0), 2e-3 + shift)
        (one,) = found.sensors
        wanted = np.interp(one.time + clock, TIME, exact)
        np.testing.assert_allclose(found.computed(columns, values), wanted, atol=0.02)


def test_a_rod_of_probes_does_not_leave_its_surface(case):
    (one,) = sensors(case, depth_deviation="1 mm").sensors
    assert one.rungs[0] == -2e-3 and one.rungs[-1] == pytest.approx(3e-3) and 0.0 in one.rungs
    (depth,) = sensors(case, depth_deviation="1 mm").unknowns()
    assert depth.deviation == pytest.approx(1e-3) and depth.low == -2e-3 and depth.high < 3e-3


def test_samples_before_and_behind_the_run_are_left_out(case):
    found = sensors(case, start="2 s", study={"clock_deviation": "1 s"})
    (one,) = found.sensors
    assert one.time[0] == 0.0 and one.time[-1] <= END - 3.0
    assert len(found.measured) == len(found.noise) == len(one.time)
    assert [unknown.name for unknown in found.unknowns()] == ["clock"]


@pytest.mark.parametrize(
    ("curve", "text"),
    [
        ({"of": "far.temperature"}, "there is no probe 'far'; probes: near"),
        ({"of": "near.von_mises", "noise": 1}, "the probe does not record it; it has: temperature"),
        ({"start": "1 h"}, r"0 samples lie within the run.*correct start or time_unit"),
        ({"time_unit": "h"}, "1 samples lie within the run"),
        ({"file": "none.csv"}, "there is no such file"),
        ({"column": "far"}, "no column 'far'; known: time, near.temperature"),
    ],
)
def test_curves_that_do_not_suit_the_case_are_refused(case, curve, text):
    with pytest.raises(CaseError, match=text):
        sensors(case, **curve)


@pytest.mark.parametrize(
    ("line", "text"),
    [("30,nan", "'nan' is no number"), ("1,300", "times must increase, and do not behind 39 s")],
)
def test_a_logger_that_fails_is_refused(case, line, text):
    file = case.path.parent / "near.csv"
    file.write_text(file.read_text() + line + "\n")
    with pytest.raises(CaseError, match=text):
        sensors(case)


def test_a_clock_that_may_be_off_by_the_whole_run_is_refused(case):
    with pytest.raises(CaseError, match=r"clock_deviation = 14 s: .*ends at 40 s; give a smaller"):
        sensors(case, study={"clock_deviation": "14 s"})


def short(case, first, last):
    """Write the samples of some seconds into a file of their own."""
    head, *rows = (case.path.parent / "near.csv").read_text().splitlines()
    rows = [row for row in rows if first <= float(row.split(",")[0]) <= last]
    (case.path.parent / "short.csv").write_text("\n".join([head, *rows]) + "\n")
    return {**CURVE, "file": "short.csv"}


def test_a_curve_that_covers_little_is_told(case, monkeypatch):
    said = []
    monkeypatch.setattr(module.log, "warning", lambda text, *args: said.append(text % args))
    far = case.probes[0].model_copy(update={"name": "far"})
    two = case.model_copy(update={"probes": (*case.probes, far)})
    whole = {**CURVE, "of": "far.temperature", "column": "near.temperature"}
    sensors(two, study={"curves": [whole, short(case, 0.0, 9.0)]})
    sensors(case, study={"curves": [short(case, 25.0, END)]})
    told = "near.temperature: its samples cover {} % of the run, from {} s"
    assert said == [told.format(22, "0 to 9"), told.format(35, "25 to 39")]


def test_samples_that_end_in_the_first_half_of_the_run_are_refused(case):
    text = r"all curves end at 15 s, and the run at 40 s: .*, or end the run with them: time.end = "
    curves = [short(case, 0.0, 15.0)]
    with pytest.raises(CaseError, match=text + "15$"):
        sensors(case, study={"curves": curves})
    with pytest.raises(CaseError, match=text + "18$"):
        sensors(case, study={"curves": curves, "clock_deviation": "1 s"})
    cured = case.model_copy(update={"time": case.time.model_copy(update={"end": 18.0})})
    (one,) = sensors(cured, study={"curves": curves, "clock_deviation": "1 s"}).sensors
    assert one.time[-1] == 15.0
    short(case, 0.0, 20.0)
    (one,) = sensors(case, study={"curves": curves}).sensors
    assert one.time[-1] == 20.0


def test_a_depth_needs_to_know_where_it_goes(case):
    probe = case.probes[0].model_copy(update={"below": None, "depth": 0.0, "at": (0.032, 5e-4)})
    free = case.model_copy(update={"probes": (probe,)})
    with pytest.raises(CaseError, match=r"direction = \[1, 0\]"):
        sensors(free, depth_deviation="0.3 mm")
    (one,) = sensors(free, depth_deviation="0.3 mm", direction=[2, 0]).sensors
    with pytest.raises(CaseError, match=r"direction = \[1.0, 0.0, 0.0\] needs as many numbers"):
        sensors(free, depth_deviation="0.3 mm", direction=[1, 0, 0])
    rows = one.rung_probes({"name": "near", "body": "mould", "at": ["32 mm", "0.5 mm"]})
    assert rows[0]["at"] == pytest.approx([0.0311, 5e-4]) and rows[0]["name"] == "near +0"
    surface = case.probes[0].model_copy(update={"depth": 0.0})
    with pytest.raises(CaseError, match="a sensor on the surface"):
        sensors(case.model_copy(update={"probes": (surface,)}), depth_deviation="0.3 mm")
