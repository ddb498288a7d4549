"""Problems with their key path, and the message that shows them."""

import pickle

import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.input.problems import (
    Problem,
    Refusal,
    RefusedFile,
    among,
    dotted,
    refuse,
    show,
    summary,
)

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "path, expected",
    [
        ((), ""),
        (("time", "end"), "time.end"),
        (("bodies", 1, "material"), "bodies[1].material"),
        (("materials", "AlCu4.5", "density"), 'materials."AlCu4.5".density'),
        (("a b", 0), '"a b"[0]'),
        (("Größe",), '"Größe"'),
        (("x" * 70,), f'"{"x" * 64} ..."'),
    ],
)
def test_paths_are_written_as_in_toml(path, expected):
    assert dotted(path) == expected


@pytest.mark.parametrize(
    "value, expected",
    [("5 mm", '"5 mm"'), ([1, True, None], "[1, true, null]"), (float("nan"), "NaN"), ("ä", '"ä"')],
)
def test_values_are_shown_as_they_are_written(value, expected):
    assert show(value) == expected


@given(st.recursive(st.text() | st.integers(), lambda inner: st.lists(inner)))
def test_no_value_is_shown_at_length(value):
    assert len(show(value)) <= 80


def test_a_value_that_holds_itself_can_be_shown():
    endless: list[object] = []
    endless.append(endless)
    assert show(endless) == "[[...]]"


def test_the_nearest_of_the_known_names_is_guessed():
    known = ["conductivity", "Density", "expansion"]
    assert among("densty", known) == (
        'known: conductivity, Density, expansion (did you mean "Density"?)'
    )
    assert among("xyz", known, what="keys") == "keys: conductivity, Density, expansion"
    assert among("x", []) == "known: none"
    columns = ["Time [s]", "TC1 [°C]", "TC2 [°C]"]
    assert among("TC 1", columns).endswith('(did you mean "TC1 [°C]"?)')


def test_a_refusal_is_seen_from_outside():
    inner = Refusal([Problem(("end",), "too late"), Problem((), "says nothing")])
    outer = inner.inside("stages", 2)
    assert [problem.path for problem in outer.problems] == [("stages", 2, "end"), ("stages", 2)]
    assert str(outer) == "stages[2].end: too late; stages[2]: says nothing"
    assert refuse("no", "a", 1).problems == (Problem(("a", 1), "no"),)


DATA = {"time": {"end": -1}, "bodies": [{"name": "a/b"}]}


def test_one_problem_stands_on_one_line_with_its_value():
    problems = [Problem(("time", "end"), "must be positive")]
    assert summary("case.toml", problems, DATA) == "case.toml: time.end = -1: must be positive"


def test_several_problems_stand_below_each_other():
    problems = [
        Problem(("time",), "needs a step"),
        Problem(("bodies", 0, "name"), "no slash"),
        Problem(("bodies", 3, "name"), "missing"),
        Problem((), "says nothing"),
    ]
    assert summary("case.toml", problems, DATA).splitlines() == [
        "case.toml: 4 problems",
        "  time: needs a step",
        '  bodies[0].name = "a/b": no slash',
        "  bodies[3].name: missing",
        "  says nothing",
    ]


def test_of_many_problems_the_first_are_shown():
    lines = summary("case.toml", [Problem(("a", i), "wrong") for i in range(100)], {}).splitlines()
    assert lines[0] == "case.toml: 100 problems" and lines[-1] == "  ... and 70 more"
    assert len(lines) == 32 and lines[30] == "  a[29]: wrong"


@pytest.mark.parametrize(
    "refusal",
    [
        refuse("is too hot", "bodies", 0),
        RefusedFile("a.toml", [Problem(("end",), "is too late")], {"end": 5}),
    ],
)
def test_a_refusal_is_the_same_on_the_rank_that_it_is_sent_to(refusal):
    sent = pickle.loads(pickle.dumps(refusal))
    assert type(sent) is type(refusal) and sent.problems == refusal.problems
    assert str(sent) == str(refusal)
