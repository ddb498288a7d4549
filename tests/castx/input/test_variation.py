"""Coefficients that are constant or vary with one quantity."""

import pytest

from castx.input.entries import Quantity
from castx.input.problems import Refusal
from castx.input.units import HEAT_TRANSFER
from castx.input.variation import Variation, Varying
from castx.tables import Table

pytestmark = pytest.mark.serial

COEFFICIENT = Quantity(HEAT_TRANSFER, least=0.0)
BY_ALL = Varying(COEFFICIENT, ("temperature", "time", "gap"), ("film", "surface"), rows=True)
BY_GAP = Varying(COEFFICIENT, ("gap", "pressure"))


def test_a_number_does_not_vary():
    found = BY_GAP.read("2 kW/m^2/K")
    assert found.is_constant and found.table(123.0) == 2000.0


def test_plain_rows_are_over_time():
    found = BY_ALL.read([[0, 1], ["1 min", 3]])
    assert (found.over, found.of, found.table(30.0)) == ("time", "", 2.0)
    assert not found.is_constant


@pytest.mark.parametrize(
    "over, first, middle, of",
    [
        ("temperature", "293.15 K", 60.0, "film"),
        ("time", "20 s", 60.0, ""),
        ("gap", "20 m", 60.0, ""),
    ],
)
def test_the_first_column_has_the_unit_of_its_quantity(over, first, middle, of):
    found = BY_ALL.read({"over": over, "table": [[first, 0], [100, "8 W/m^2/K"]]})
    assert (found.over, found.of) == (over, of)
    assert found.table(middle) == pytest.approx(4.0)


def test_the_temperature_that_counts_can_be_chosen():
    given = {"over": "temperature", "table": [[20, 1], [30, 2]], "of": "surface"}
    assert BY_ALL.read(given).of == "surface"


def test_what_has_been_read_is_taken_as_it_is():
    found = Variation(Table.constant(5.0), "gap")
    assert BY_GAP.read(found) is found
    assert BY_GAP.read(Table.constant(4.0)).over == "time"


@pytest.mark.parametrize(
    "kind, value, text",
    [
        (BY_GAP, -1, "must be at least 0"),
        (BY_GAP, [[0, 1]], r'a table needs its argument: { over = "gap" or "pressure"'),
        (BY_GAP, {"over": "gap"}, "table: missing; both over and table"),
        (BY_GAP, {"table": [[0, 1]]}, "over: missing; both over and table"),
        (BY_GAP, {"over": "time", "table": [[0, 1]]}, "over: unknown; allowed: gap, pressure"),
        (BY_GAP, {"over": "gap", "table": [[0, 1]], "off": 1}, "off: unknown key.*known keys"),
        (BY_GAP, {"over": "gap", "table": [[-1, 1]]}, r"table\[0\]: must be at least 0"),
        (BY_GAP, {"over": "gap", "table": []}, "table: a table needs 1 to"),
        (BY_GAP, {"over": "gap", "table": [[0, 1]], "of": "film"}, "of: only a table over temp"),
        (BY_ALL, {"over": "temperature", "table": [[0, 1]], "of": "core"}, "of: unknown; allowed"),
    ],
)
def test_refused(kind, value, text):
    with pytest.raises((Refusal, ValueError), match=text):
        kind.read(value)
