"""Kinds of entries of a case file."""

from typing import Annotated

import numpy as np
import pytest

from castx.errors import CaseError
from castx.input.entries import (
    LONGEST_TABLE,
    Choice,
    Description,
    EntryName,
    Name,
    Quantity,
    Whole,
    over_temperature,
    over_time,
)
from castx.input.problems import Problem, Refusal, summary
from castx.input.units import CONDUCTIVITY, LENGTH, PURE_NUMBER
from castx.tables import Table

pytestmark = pytest.mark.serial


class Inner(Description):
    length: Annotated[float, Quantity(LENGTH, above=0.0)]
    count: Annotated[int, Whole(0, 3)] = 0

    def inconsistencies(self):
        if self.length > 10.0:
            yield Problem(("length",), "longer than everything")


class Outer(Description):
    name: EntryName
    inner: Inner
    many: tuple[Inner, ...] = ()
    choice: Annotated[str, Choice(("one", "two"))] = "one"


def problems_of(data):
    with pytest.raises(Refusal) as caught:
        Outer.read(data)
    return summary("file", caught.value.problems, data)


def test_all_problems_are_found_with_their_paths():
    data = {
        "name": "a/b",
        "inner": {"length": "-3 mm", "lenght": 3, "count": 4},
        "many": [{"length": 1}, {"length": 11}, {}, 5],
        "choice": "three",
        "chioce": "one",
    }
    assert problems_of(data).splitlines() == [
        "file: 9 problems",
        "  name = \"a/b\": a name has 1 to 64 letters, digits, '_', '+', '-' or inner spaces",
        '  inner.length = "-3 mm": must be positive (in m)',
        "  inner.count = 4: a whole number from 0 to 3 is needed",
        '  inner.lenght = 3: unknown key; known keys: length, count (did you mean "length"?)',
        "  many[1].length = 11: longer than everything",
        "  many[2].length: missing; this key is needed",
        "  many[3] = 5: a table of keys is needed: { key = value, ... }",
        '  choice = "three": unknown; allowed: one, two',
        '  chioce = "one": unknown key; known keys: name, inner, many, choice '
        '(did you mean "choice"?)',
    ]


def test_a_single_problem_fits_on_one_line():
    data = {"name": "a", "inner": {"length": 1}, "choice": "Two"}
    expected = 'file: choice = "Two": unknown; allowed: one, two (did you mean "two"?)'
    assert problems_of(data) == expected


def test_many_problems_and_long_values_are_cut():
    data = {"name": "a", "inner": {"length": 1}, "many": [0] * 500, "x" * 999: "y" * 999}
    text = problems_of(data)
    assert "... and " in text and text.count("\n") <= 31 and len(text) < 5000


def test_a_description_is_frozen():
    outer = Outer.read({"name": "a", "inner": {"length": "5 mm"}})
    assert outer.inner.length == 0.005 and outer.choice == "one"
    with pytest.raises(ValueError, match="frozen"):
        outer.name = "b"


@pytest.mark.parametrize("name", ["casting", "steel-H13", "Gießpfanne 2", "a+b", "3_x"])
def test_names(name):
    assert Outer.read({"name": name, "inner": {"length": 1}}).name == name


@pytest.mark.parametrize("name", ["", " a", "a/b", "a.b", "../a", "a\n", "a" * 65, 3, None, ["a"]])
def test_refused_names(name):
    with pytest.raises(Refusal, match=r"^name: a name"):
        Outer.read({"name": name, "inner": {"length": 1}})


@pytest.mark.parametrize("name", ["AlCu4.5", "1.2344", "G-AlSi7 v2.1"])
def test_names_of_materials_may_have_dots(name):
    assert Name(dots=True).read(name) == name


@pytest.mark.parametrize("name", [".a", "a.", "a/b", "..", ""])
def test_names_of_materials_are_no_paths(name):
    with pytest.raises(CaseError, match="inner dots"):
        Name(dots=True).read(name)


@pytest.mark.parametrize(
    "bounds, value, text",
    [
        ({"above": 0.0}, 0, "must be positive$"),
        ({"above": -1.0, "below": 0.5}, 0.5, "must be above -1 and below 0.5$"),
        ({"least": 0.0, "most": 1.0}, 1.1, "must be at least 0 and at most 1$"),
        ({"least": 0.0}, -1e-9, "must be at least 0$"),
    ],
)
def test_ranges(bounds, value, text):
    with pytest.raises(CaseError, match=text):
        Quantity(PURE_NUMBER, **bounds).read(value)


CONDUCTIVITIES = over_temperature(CONDUCTIVITY, above=0.0)


def test_a_number_is_a_constant_table():
    table = CONDUCTIVITIES.read("0.2 W/mm/K")
    assert table.is_constant and table(1234.0) == 200.0


def test_table_with_units():
    table = CONDUCTIVITIES.read([[20, 237], ["933.15 K", "0.210 W/mm/K"]])
    np.testing.assert_allclose(table.arguments, [20.0, 660.0])
    np.testing.assert_allclose(table.values, [237.0, 210.0])
    assert table(340.0) == pytest.approx(223.5) and table(900.0) == pytest.approx(210.0)


def test_a_table_that_is_one_already_is_checked():
    good, bad = Table.constant(3.0), Table.from_points([[0, 1], [1, -1]])
    assert CONDUCTIVITIES.read(good) is good
    with pytest.raises(CaseError, match="must be positive"):
        CONDUCTIVITIES.read(bad)


@pytest.mark.parametrize(
    "rows, path, text",
    [
        ([[20, 237], [660, -210]], (1,), r"must be positive \(in W/m/K\)"),
        ([[20, 237], [660, "210 W/m^2/K"]], (1,), "a thermal conductivity is needed in W/m/K"),
        ([["20 s", 237]], (0,), "a temperature is needed"),
        ([[20, 237], [20, 210]], (1,), r"must increase strictly, but follows \[20, 237\]"),
        ([[660, 210], [20, 237]], (1,), "must increase strictly"),
        ([[20, 237, 3]], (0,), "a row of a table needs two numbers: a temperature and a value"),
        ([20, 237], (0,), "a row of a table needs two numbers"),
        ([[20, True]], (0,), "a thermal conductivity is needed"),
        ([[20, float("nan")]], (0,), "must be finite"),
    ],
)
def test_refused_rows(rows, path, text):
    with pytest.raises(Refusal, match=text) as caught:
        CONDUCTIVITIES.read(rows)
    assert caught.value.problems[0].path == path


@pytest.mark.parametrize("rows", [[], [[i, 1.0] for i in range(LONGEST_TABLE + 1)]])
def test_table_sizes_are_bounded(rows):
    with pytest.raises(CaseError, match=f"1 to {LONGEST_TABLE} rows, got {len(rows)}"):
        over_time(LENGTH).read(rows)


def test_a_part_of_a_case_is_built_when_it_is_first_read():
    """Most are built as parts of others: each by itself would double the start of a command."""

    class Part(Description):
        length: Annotated[float, Quantity(LENGTH)] = 1.0

    class All(Description):
        part: Part

    assert not Part.__pydantic_complete__ and not All.__pydantic_complete__
    assert All.read({"part": {"length": "2 mm"}}).part.length == 2e-3
    assert All.__pydantic_complete__ and not Part.__pydantic_complete__
