"""Tables of studies in a case file."""

from pathlib import Path

import pytest

from castx.case.case import STUDIES
from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.studies.asked.optimise import Optimise
from castx.studies.asked.reading import KINDS, read_study, studies_of
from castx.studies.asked.vary import Vary
from tests.castx.many_runs import CASE

pytestmark = pytest.mark.serial

TABLE = """
[vary]
draws = 4
[[vary.inputs]]
of = "time.end"
low = 4
high = 8
"""


def file(tmp_path, text):
    path = tmp_path / "case.toml"
    path.write_text(CASE + text)
    return path


def test_it_is_read_beside_the_case_and_does_not_change_it(tmp_path):
    path = file(tmp_path, TABLE)
    assert read_study(path, Vary).number_of_runs == 4
    assert read_study(path, Vary, ["vary.draws=6"]).number_of_runs == 6
    alone = load_case(path)
    assert "vary" not in alone.content
    path.write_text(CASE)
    assert load_case(path).digest == alone.digest


def test_too_few_draws_to_tell_inputs_apart_are_warned_of(tmp_path, caplog):
    path = file(tmp_path, TABLE)
    read_study(path, Vary, ["vary.draws=3"])
    read_study(path, Vary, ["vary.draws=2", "vary.method=morris"])
    assert caplog.text == ""
    read_study(path, Vary, ["vary.draws=2"])
    assert "2 runs are too few to tell 1 inputs apart: that takes draws = 3" in caplog.text


def test_what_is_wrong_is_named_with_its_place(tmp_path):
    path = file(tmp_path, TABLE.replace("low = 4", "low = 9"))
    text = r"case.toml: vary.inputs\[0\].low = 9: must lie below high"
    for ask in (lambda: read_study(path, Vary), lambda: studies_of(path)):
        with pytest.raises(CaseError, match=text):
            ask()


def test_a_case_without_it_is_refused(tmp_path):
    with pytest.raises(CaseError, match=r"has no table \[vary\]"):
        read_study(file(tmp_path, ""), Vary)


def test_a_goal_that_no_run_answers_is_refused_before_the_first_one(tmp_path):
    table = """
[optimise]
goal = "Freezes lst: casting"
[[optimise.limits]]
of = "Largest gap: casting/mould"
most = 20
[[optimise.inputs]]
of = "time.end"
low = 4
high = 8
"""
    path = file(tmp_path, table)
    first = r'optimise.goal = "Freezes lst: casting": no run .*did you mean "Freezes last: casting"'
    text = rf"2 problems\n  {first}[^\n]*\n  optimise.limits\[0\].of = .*: needs mechanics"
    for ask in (lambda: read_study(path, Optimise), lambda: studies_of(path)):
        with pytest.raises(CaseError, match=text):
            ask()


def test_all_studies_have_a_description(tmp_path):
    assert set(KINDS) == set(STUDIES)
    assert list(studies_of(file(tmp_path, TABLE))) == ["vary"]


def test_the_demo_has_all_studies():
    demo = Path(__file__).parents[4] / "demos/interface_study.toml"
    assert list(studies_of(demo)) == list(STUDIES)
