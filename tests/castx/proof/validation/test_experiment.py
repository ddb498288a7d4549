from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from castx.errors import CaseError
from castx.proof.validation.band import overrides_of, refuse_without_ranges
from castx.proof.validation.experiment import (
    CASE,
    Fall,
    MeasuredAnswer,
    chosen,
    experiments,
    missing_texts,
    read_experiment,
)
from castx.results.files.column_units import unit_of
from castx.results.files.run_tables import Columns
from castx.studies.vary import refuse_unusable

pytestmark = pytest.mark.serial

ROOT = Path(__file__).parents[4] / "validation"
FACTS = """
title = "a bar"
source = "made up"
summary = "it cools"
digits = [
  { name = "force", value = 12, unit = "N", uncertainty = 0.5 },
  { name = "length", value = "missing: not read", unit = "mm" },
]
[[ratios]]
name = "force over itself"
of = "force"
over = "force"
model = 1
because = "of arithmetic"
"""


def columns(**curves):
    return Columns({name.replace("__", "."): np.array(of, float) for name, of in curves.items()})


RUN = SimpleNamespace(
    probes=columns(gap__gap=[0, 5, -1, 2], middle__temperature=[200, 100, 120, 60]),
    history=columns(time=[0, 1, 2, 3], **{"a/b.force.z": [0, 1, 4, 3]}),
    history_unit=lambda column: unit_of(column, "axisymmetric"),
)
"""Tables of a run of four moments."""
RANGE = '[[ranges]]\nof = "time.end"\nlow = 1\nhigh = 2\nbecause = "made up"\n'


def written(folder, facts=FACTS, case='[geometry]\nfile = "missing: a mesh"\n'):
    folder.mkdir(parents=True)
    (folder / "experiment.toml").write_text(facts)
    (folder / "case.toml").write_text(case)
    return folder


def test_what_is_missing_is_named_with_its_reason(tmp_path):
    experiment = read_experiment(written(tmp_path / "bar"))
    assert experiment.missing == ("length: not read", "case.toml: geometry.file: a mesh")
    with pytest.raises(CaseError, match="2 digits are missing, and none is invented") as refusal:
        experiment.refuse_incomplete()
    assert all(line in str(refusal.value) for line in experiment.missing)
    assert experiment.ratio(experiment.facts.ratios[0]) == 1.0


def test_a_ratio_of_missing_digits_has_no_value(tmp_path):
    facts = FACTS.replace('over = "force"', 'over = "length"')
    experiment = read_experiment(written(tmp_path / "bar", facts))
    assert experiment.ratio(experiment.facts.ratios[0]) is None


def test_without_measurements_there_is_nothing_to_compare(tmp_path):
    facts = FACTS.replace('"missing: not read"', "3")
    experiment = read_experiment(written(tmp_path / "bar", facts, "[geometry]\n"))
    assert not experiment.missing
    with pytest.raises(CaseError, match="no \\[\\[measurements\\]\\]"):
        experiment.refuse_incomplete()


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("value = 12", 'value = "about 12"', "a number is needed"),
        ("value = 12", "value = true", "a number is needed"),
        ("uncertainty = 0.5", "uncertainty = -1", "a positive number is needed"),
        ("uncertainty = 0.5", 'uncertainty = "small"', "not stated"),
        ('of = "force"', 'of = "strength"', "no such digit"),
        ('source = "made up"', "", "source"),
        ("title", "titel", "unknown key"),
        ("[[ratios]]", '[[answers]]\ndigit = "a"\ncolumn = "a.gap"\n[[ratios]]', "no such digit"),
        ("[[ratios]]", f"{RANGE}{RANGE}[[ratios]]", "has a range already"),
        ("[[ratios]]", RANGE.replace("low = 1", "low = 3") + "[[ratios]]", "must lie below high"),
    ],
)
def test_what_does_not_make_sense_is_refused(tmp_path, before, after, said):
    folder = written(tmp_path / "bar", FACTS.replace(before, after, 1))
    with pytest.raises(CaseError, match=said) as refusal:
        read_experiment(folder)
    assert "experiment.toml" in str(refusal.value)


@pytest.mark.parametrize(("moment", "number"), [("end", 2.0), ("largest", 5.0), ("smallest", -1.0)])
def test_an_answer_is_a_number_of_a_curve(moment, number):
    answer = MeasuredAnswer(digit="a", column="gap.gap", moment=moment)
    assert answer.of_run(RUN) == number
    assert answer.unit_of(RUN) == "m"


@pytest.mark.parametrize(
    ("opposite", "end", "moment"), [(False, 2.0, "largest"), (True, -2.0, "smallest")]
)
def test_an_answer_may_count_the_other_way_round(opposite, end, moment):
    answer = MeasuredAnswer(digit="a", column="gap.gap", opposite=opposite)
    assert answer.of_run(RUN) == end
    turned = MeasuredAnswer(digit="a", column="gap.gap", opposite=opposite, moment=moment)
    assert abs(turned.of_run(RUN)) == 5.0


def test_nothing_the_other_way_round_is_no_negative_zero():
    answer = MeasuredAnswer(digit="a", column="a/b.force.z", moment="largest", opposite=True)
    assert str(answer.of_run(RUN)) == "0.0"


def test_an_answer_of_the_history_has_its_unit():
    answer = MeasuredAnswer(digit="a", column="a/b.force.z", moment="largest")
    assert (answer.of_run(RUN), answer.unit_of(RUN)) == (4.0, "N")
    with pytest.raises(CaseError, match=r"there is no 'a/b\.force\.x'"):
        MeasuredAnswer(digit="a", column="a/b.force.x").of_run(RUN)


@pytest.mark.parametrize(
    ("to", "number"),
    [(150.0, 2.5), (90.0, -1.0 + 0.5 * 3.0), (500.0, 0.0), (60.0, 2.0)],
)
def test_an_answer_is_taken_when_another_curve_has_fallen_for_good(to, number):
    """The temperature is 200, 100, 120, 60 °C at 0, 1, 2, 3 s; the gap 0, 5, -1, 2 m."""
    fall = Fall(column="middle.temperature", to=to)
    assert MeasuredAnswer(digit="a", column="gap.gap", when=fall).of_run(RUN) == pytest.approx(
        number
    )


def test_a_fall_that_never_comes_and_two_moments_are_refused():
    fall = Fall(column="middle.temperature", to=50.0)
    with pytest.raises(CaseError, match=r"middle\.temperature ends at 60, above 50"):
        MeasuredAnswer(digit="a", column="gap.gap", when=fall).of_run(RUN)
    given = {"digit": "a", "column": "gap.gap", "moment": "end"}
    with pytest.raises(CaseError, match="says the moment"):
        MeasuredAnswer.read({**given, "when": {"column": "middle.temperature", "to": 50}})


def test_texts_are_found_at_any_depth():
    data = {"a": [{"b": "missing: x"}, 1], "c": "missing", "d": "not missing"}
    assert list(missing_texts(data)) == [(("a", 0, "b"), "missing: x"), (("c",), "missing")]


def test_experiments_are_chosen_by_their_names(tmp_path):
    written(tmp_path / "bar"), written(tmp_path / "arm")
    assert [experiment.name for experiment in experiments(tmp_path)] == ["arm", "bar"]
    assert chosen(tmp_path, "bar").name == "bar"
    with pytest.raises(CaseError, match="no experiment 'bat'"):
        chosen(tmp_path, "bat")
    with pytest.raises(CaseError, match="--folder"):
        experiments(tmp_path / "bar")
    (tmp_path / "bar" / "case.toml").unlink()
    with pytest.raises(CaseError, match=r"case\.toml: cannot be read"):
        experiments(tmp_path)


def test_the_experiments_of_the_project_lack_digits_and_say_which():
    found = {experiment.name: experiment for experiment in experiments(ROOT)}
    assert set(found) == {"ac4ch_tube", "dumbbell", "sand_ring", "cylindrical_mould"}
    for experiment in found.values():
        refuse_without_ranges(experiment)
        given = overrides_of(experiment)
        refuse_unusable(experiment.folder / CASE, given, experiment.facts.ranges, "ranges")
        assert all(one.because for one in experiment.facts.ranges)
        assert experiment.missing
        assert experiment.case["measurements"]
        with pytest.raises(CaseError, match="digits are missing"):
            experiment.refuse_incomplete()
    bar = found["dumbbell"]
    ratios = [bar.ratio(ratio) for ratio in bar.facts.ratios]
    assert ratios == pytest.approx([6.25 / 6.26, 265 / 729, 0.06 / 6.26])
