"""Keys of rules: unit, default and text; numbers whose unit depends on the exponent."""

from __future__ import annotations

import pytest

from castx.errors import CaseError
from castx.input.entries import over_temperature
from castx.input.units import DENSITY, HEAT_FLUX, PURE_NUMBER, STRESS, TEMPERATURE, VISCOSITY
from castx.materials.rules.key import PlainQuantity, RuleKey, unit_text

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    ("dimension", "text"),
    [(DENSITY, "kg/m³"), (HEAT_FLUX, "W/m²"), (VISCOSITY, "Pa s"), (TEMPERATURE, "°C"),
     (PURE_NUMBER, "")],
)  # fmt: skip
def test_units_as_people_write_them(dimension, text) -> None:
    assert unit_text(dimension) == text


def test_the_unit_is_that_of_the_dimension_unless_written() -> None:
    entry = over_temperature(STRESS, above=0.0)
    assert RuleKey("limit", "limit", entry).unit == "Pa"
    assert RuleKey("limit", "limit", entry, written_unit="Pa^n").unit == "Pa^n"


def test_text_and_default() -> None:
    needed = RuleKey("limit", "limit", over_temperature(STRESS, above=0.0))
    assert (needed.text, needed.default_table) == ("limit [Pa]", None)
    other = RuleKey("power", "power", over_temperature(PURE_NUMBER), default=2.5)
    assert other.text == "power = 2.5"
    assert other.default_table is not None and other.default_table(100.0) == 2.5


def test_a_plain_quantity_has_no_unit() -> None:
    quantity = PlainQuantity(STRESS, above=0.0)
    assert quantity.read(2) == 2.0
    with pytest.raises(CaseError, match="a plain number in Pa is needed: its unit depends"):
        quantity.read("2 Pa")
    with pytest.raises(CaseError, match="must be positive"):
        quantity.read(-2)
