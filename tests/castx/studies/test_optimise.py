"""Optima of formulas that are known, within limits; failures; goals that no run has."""

import json

import pytest

from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.studies.asked.optimise import Optimise
from castx.studies.optimise import RESULT, optimise
from castx.studies.runs.runner import Runner
from tests.castx.many_runs import CASE, Formulas

pytestmark = pytest.mark.serial

INPUTS = [
    {"of": "bodies.0.temperature", "name": "pouring", "low": 640, "high": 700},
    {"of": "geometry.wall", "name": "wall", "low": "10 mm", "high": "40 mm"},
]


def bowl(content):
    """Least 1 at 660 °C and 20 mm; "hot" counts how far above 650 °C; no run above 690 °C."""
    hot = content["bodies"][0]["temperature"]
    wall = float(content["geometry"]["wall"].split()[0])
    if hot > 690.0:
        raise RuntimeError("boils")
    value = 1.0 + ((hot - 660.0) / 30.0) ** 2 + ((wall - 20.0) / 10.0) ** 2
    return {"bowl": value, "hot": hot - 650.0}, {"time": [0.0, 1.0]}


def best(tmp_path, executor=None, **keys):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    folder = tmp_path / "study"
    folder.mkdir(exist_ok=True)
    study = Optimise.read({"goal": "bowl", "inputs": INPUTS, **keys})
    return optimise(Runner(path, (), folder, executor or Formulas(bowl)), study)


@pytest.mark.parametrize(("method", "runs"), [("differential-evolution", 100), ("nelder-mead", 60)])
def test_the_least_is_found(tmp_path, method, runs):
    found = best(tmp_path, method=method, runs=runs)
    pouring, wall = found.table.values[found.best]
    assert abs(pouring - 660.0) < 3.0 and abs(wall - 20.0) < 1.0 and found.within
    assert len(found.table.runs) <= runs
    case = load_case(found.case_file)
    assert case.content["bodies"][0]["temperature"] == pouring
    record = json.loads((tmp_path / "study" / RESULT).read_text())
    assert record["answers"]["bowl"] < 1.03 and record["inputs"]["wall"] == wall


def test_a_limit_is_kept(tmp_path):
    found = best(
        tmp_path, method="nelder-mead", inputs=INPUTS[:1], limits=[{"of": "hot", "most": 0.0}]
    )
    (pouring,) = found.table.values[found.best]
    assert found.within and 649.0 < pouring <= 650.0


def test_a_limit_that_cannot_be_kept_is_told(tmp_path):
    found = best(tmp_path, runs=20, limits=[{"of": "hot", "most": -100.0}])
    assert not found.within and found.table.values[found.best][0] < 650.0
    assert found.remarks[0] == "No run keeps all limits; this one is nearest."


def test_a_search_that_has_not_settled_says_so(tmp_path):
    """With more runs it goes on, and makes those only that it lacks."""
    short, settled = Formulas(bowl), Formulas(bowl)
    first = best(tmp_path, short, method="nelder-mead", runs=8)
    (told,) = first.remarks
    assert first.spent and told.startswith("The search had not settled when its 8 runs were spent")
    last = best(tmp_path, settled, method="nelder-mead", runs=60)
    assert not last.spent and last.remarks == []
    assert len(settled.made) == len({run.digest for run in last.table.runs}) - len(short.made)


def test_the_most_lies_at_an_end(tmp_path):
    found = best(tmp_path, method="nelder-mead", direction="most", inputs=INPUTS[1:])
    assert found.table.values[found.best][0] == pytest.approx(40.0, abs=0.5)


def test_a_second_study_makes_no_run(tmp_path):
    first, second = Formulas(bowl), Formulas(bowl)
    one, two = best(tmp_path, first, runs=20), best(tmp_path, second, runs=20)
    assert len(first.made) == len(one.table.runs) and not second.made
    assert one.table.text() == two.table.text()


def test_what_no_run_answers_is_refused(tmp_path):
    with pytest.raises(CaseError, match=r"no run has answered 'bowls'.*did you mean \"bowl\""):
        best(tmp_path, goal="bowls", runs=20)

    def failing(content):
        raise RuntimeError("never")

    with pytest.raises(CaseError, match=r"not one of \d+ runs has answered 'bowl'.*never"):
        best(tmp_path, Formulas(failing), runs=12, seed=1)
