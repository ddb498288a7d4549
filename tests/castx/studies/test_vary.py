"""Studies with runs that answer by a formula: values, table, resumption, refusals."""

import json

import numpy as np
import pytest

from castx.errors import CaseError
from castx.studies.asked.vary import Vary
from castx.studies.runs.runner import Runner
from castx.studies.vary import PAGE, STUDY, TABLE, sampled, vary
from tests.castx.many_runs import CASE, Formulas

pytestmark = pytest.mark.serial

INPUTS = [
    {"of": "bodies.0.temperature", "name": "pouring", "low": 650, "high": 690},
    {"of": "geometry.wall", "low": "20 mm", "high": "30 mm"},
]


def freezing(content):
    """10 s at 650 °C and 20 mm, 8 s more at 690 °C, 1 s less at 30 mm; thick and hot ones fail."""
    hot = (content["bodies"][0]["temperature"] - 650.0) / 40.0
    thick = (float(content["geometry"]["wall"].split()[0]) - 20.0) / 10.0
    if hot > 0.9 and thick > 0.9:
        raise RuntimeError("no")
    frozen = 10.0 + 8.0 * hot - thick
    return {"Freezes last: casting": frozen, "Kou": 7.0}, {
        "time": [0.0, frozen], "near.temperature": [0.0, frozen],
    }  # fmt: skip


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


def made(case_file, executor, **keys):
    study = Vary.read({"inputs": INPUTS, **keys})
    folder = case_file.parent / "study"
    folder.mkdir(exist_ok=True)
    return vary(Runner(case_file, (), folder, executor), study), folder


def test_a_grid_with_a_failed_run(case_file):
    found, folder = made(case_file, Formulas(freezing), method="grid")
    assert found.table.values.tolist()[:4] == [[650, 20], [650, 25], [650, 30], [670, 20]]
    assert [run.ended for run in found.table.runs] == ["finished"] * 8 + ["not converged"]
    (one,) = found.importance
    changes = {effect.name: effect.change for effect in one.effects}
    assert changes == pytest.approx({"pouring": 8.0, "geometry.wall": -1.0})
    assert "1 of 9 runs" in one.remark
    lines = (folder / TABLE).read_text().splitlines()
    heads = ["pouring [°C]", "geometry.wall [mm]", "Freezes last: casting [s]"]
    assert lines[0].split(",")[:5] == ["folder", "ended", *heads]
    assert len(lines) == 10
    record = json.loads((folder / STUDY).read_text())
    assert record["runs"][8]["answers"] == {} and "no" in record["runs"][8]["said"]
    page = (folder / PAGE).read_text()
    assert "it hangs on pouring (+8 s), then geometry.wall (-1 s)" in page
    assert "near.temperature" in page
    (band,) = found.bands
    assert band.high[-1] <= 18.0 and band.low[-1] == pytest.approx(9.0, abs=0.5)


def test_a_killed_study_gives_the_same_table(case_file, tmp_path):
    with pytest.raises(KeyboardInterrupt):
        made(case_file, Formulas(freezing, dies_after=3), draws=8)
    _, folder = made(case_file, resumed := Formulas(freezing), draws=8)
    assert len(resumed.made) == 5
    other = tmp_path / "other"
    other.mkdir()
    vary(
        Runner(case_file, (), other, Formulas(freezing)), Vary.read({"inputs": INPUTS, "draws": 8})
    )
    assert (folder / TABLE).read_text() == (other / TABLE).read_text()


def test_values_of_a_grid_and_their_units():
    study = Vary.read({
        "method": "grid",
        "inputs": [{"of": "a", "values": ["1 mm", "4 mm", "16 mm"]}, {**INPUTS[0], "points": 2}],
    })  # fmt: skip
    points, values = sampled(study)
    assert values == [[w, t] for w in ("1.0 mm", "4.0 mm", "16.0 mm") for t in (650.0, 690.0)]
    assert points[:, 0].tolist() == [0.0, 0.0, 0.5, 0.5, 1.0, 1.0]


def test_sobol_of_a_straight_case(case_file):
    found, _ = made(case_file, Formulas(freezing), method="sobol", draws=16, inputs=[INPUTS[0]])
    (one,) = found.importance
    assert one.effects[0].more["first-order index"] == pytest.approx(1.0, abs=0.05)
    assert one.effects[0].change == pytest.approx(8.0)
    assert not np.isnan(found.table.values).any()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"of": "bodies.0.temperatur"}, r"\[vary\] .*temperatur.*unknown key"),
        ({"of": "bodies.7.temperature"}, "has no '7'"),
        ({"low": -300}, "below absolute zero"),
        ({"of": "materials.di.density"}, r'no \[materials.di\]; .*did you mean "die"'),
        ({"of": "vary.draws"}, r"\[vary\] is a study; a number of the case is needed"),
        ({"low": "20 mm", "high": "30 mm"}, "is not a unit of temperature"),
    ],
)
def test_inputs_that_the_case_does_not_take_are_refused_before_a_run(case_file, change, text):
    executor = Formulas(freezing)
    with pytest.raises(CaseError, match=text):
        made(case_file, executor, inputs=[{**INPUTS[0], "name": "pouring", **change}])
    assert not executor.made


def test_each_value_of_a_grid_is_tried_before_a_run(case_file):
    executor = Formulas(freezing)
    one = {"of": "bodies.0.temperature", "values": [650, -300, 690]}
    with pytest.raises(CaseError, match=r"temperature = -300.0: below absolute zero"):
        made(case_file, executor, method="grid", inputs=[one])
    assert not executor.made


def test_a_study_of_failures_is_an_error(case_file):
    def failing(content):
        raise RuntimeError("never")

    with pytest.raises(CaseError, match=r"not one of 4 runs has finished.*never"):
        made(case_file, Formulas(failing), draws=4)
