"""Numbers that keep their unit."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.amounts import Amount, amount, in_unit, other_unit

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    ("given", "value", "unit"),
    [
        (3, 3.0, ""),
        ("2300 W/m^2/K", 2300.0, "W/m^2/K"),
        (" -1.5e3mm ", -1500.0, "mm"),
        ("7", 7.0, ""),
    ],
)
def test_it_is_read_with_its_unit(given, value, unit):
    assert amount(given) == Amount(value, unit)


@pytest.mark.parametrize("given", ["mm", True, None, [1], "", float("nan"), 1e999])
def test_what_is_no_number_is_refused(given):
    with pytest.raises(CaseError, match=r"number is needed|finite"):
        amount(given)


def test_another_value_is_written_in_its_unit():
    assert amount("2 mm").written(0.1 + 0.2) == f"{0.1 + 0.2!r} mm"
    assert amount(2).written(3) == 3.0


@pytest.mark.parametrize(
    ("given", "unit", "value"),
    [
        ("2 mm", "mm", 2.0),
        ("2 cm", "mm", 20.0),
        ("2 mm", "", 0.002),
        (0.002, "mm", 2.0),
        ("0.5 kW/m^2/K", "W/m^2/K", 500.0),
        ("200 degC", "degC", 200.0),
    ],
)
def test_the_unit_of_a_study(given, unit, value):
    assert in_unit(amount(given), unit) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(("given", "unit"), [("2 mm", "s"), ("473 K", "degC"), (473, "K")])
def test_what_cannot_be_said_in_a_unit_is_refused(given, unit):
    with pytest.raises(CaseError, match="write both in the same unit"):
        in_unit(amount(given), unit)


def test_different_units_are_told():
    assert other_unit([amount("1 mm"), None, amount("2 mm")]) == ""
    assert '"mm" and no unit' in other_unit([amount("1 mm"), amount(2)])
