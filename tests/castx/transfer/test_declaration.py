"""Declarations of laws and keys: complete or refused, with the values that a case gives."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.input.entries import Quantity
from castx.input.units import LENGTH, THERMAL_RESISTANCE
from castx.transfer.declaration import GapHeatLaw, Given, HeatKey, chosen, middle
from castx.transfer.keys import CLOSED, OPEN, PRESSURE, RADIATION, TRANSITION
from castx.transfer.laws.limited import LAW as LIMITED

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("lacking", ["name", "summary", "formula", "source"])
def test_a_law_without_one_of_its_texts_is_refused(lacking):
    with pytest.raises(TypeError, match=f"law .* declares no {lacking}$"):
        replace(LIMITED, **{lacking: ""})


def test_all_that_is_missing_is_named_at_once():
    with pytest.raises(TypeError, match="law 'new' declares no summary, no formula, no source, no"):
        GapHeatLaw(name="new")
    with pytest.raises(TypeError, match="heat key 'g0' declares no entry, no usual"):
        HeatKey("g0", "decay length")


def test_only_perfect_contact_builds_nothing():
    with pytest.raises(TypeError, match="declares no build"):
        replace(LIMITED, build=None)
    assert replace(LIMITED, build=None, exchange="perfect").build is None


def test_units_come_from_the_entries():
    assert (CLOSED.text, TRANSITION.text) == ("closed [W/m²/K]", "transition [m]")
    assert (PRESSURE.text, RADIATION.unit) == ("pressure", "")
    resistance = HeatKey("r", "resistance", Quantity(THERMAL_RESISTANCE), usual=(1e-5, 1e-3))
    assert resistance.text == "r [m² K/W]"


def test_given_values_and_defaults():
    length: HeatKey[float] = HeatKey("g0", "decay length", Quantity(LENGTH), usual=(1e-5, 1e-3))
    given = Given({"g0": 2e-4})
    assert given.need(length) == 2e-4 and given.has(length)
    assert given.need(TRANSITION) == 0.0  # its default
    assert given.get(OPEN) is None and not given.has(OPEN)


def test_examples_choose_from_every_range():
    assert chosen({"a": [(1.0, 4.0), 3.0], "b": (2.0, 8.0)}, middle) == {"a": [2.0, 3.0], "b": 4.0}
    heat = LIMITED.example(lambda low, high: high, also=(RADIATION,))
    assert heat == {
        "law": "limited", "closed": 50_000.0, "gas_conductivity": 0.3,
        "radiation": {"emissivities": [0.9, 0.9]},
    }  # fmt: skip
