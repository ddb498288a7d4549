"""A declaration that leaves something out is refused with the name of what is missing."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.input.entries import Quantity
from castx.input.units import TEMPERATURE
from castx.transfer.conditions.convection import COEFFICIENT
from castx.transfer.conditions.convection import CONDITION as CONVECTION
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.conditions.insulated import CONDITION as INSULATED
from castx.transfer.conditions.temperature import CONDITION as GIVEN
from castx.transfer.declaration import Given, HeatKey
from castx.transfer.keys import COATING

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("lacking", ["name", "summary", "formula", "source"])
def test_a_condition_without_one_of_its_texts_is_refused(lacking):
    with pytest.raises(TypeError, match=f"^the heat condition .* declares no {lacking}$"):
        replace(CONVECTION, **{lacking: ""})


@pytest.mark.parametrize(
    "kind, change",
    [
        (CONVECTION, {"flux": None}),
        (GIVEN, {"temperature": None}),
        (INSULATED, {"insulates": False}),
        (CONVECTION, {"insulates": True}),
        (CONVECTION, {"temperature": GIVEN.temperature}),
    ],
)
def test_a_condition_gives_one_of_flux_temperature_and_nothing(kind, change):
    text = f"'{kind.name}' must declare one of flux, temperature and insulates=True"
    with pytest.raises(TypeError, match=text):
        replace(kind, **change)


def test_keys_are_there_and_are_numbers():
    with pytest.raises(TypeError, match="'convection' declares no keys"):
        replace(CONVECTION, keys=())
    with pytest.raises(TypeError, match="'convection': the key 'coating' is neither a number nor"):
        replace(CONVECTION, keys=(COATING,))
    with pytest.raises(TypeError, match="declares no summary, no formula, no source"):
        HeatConditionKind(name="new")


def test_keys_by_name_and_those_that_are_needed():
    optional = replace(COEFFICIENT, default=5.0)
    kind = replace(CONVECTION, keys=(optional, CONVECTION.keys[1]))
    assert (CONVECTION.needed, kind.needed) == (("coefficient", "ambient"), ("ambient",))
    assert kind.key("coefficient") is optional and kind.key("value") is None


def test_a_temperature_that_is_one_number_counts_too():
    inlet: HeatKey[float] = HeatKey(
        "inlet", "of the fluid", Quantity(TEMPERATURE), usual=(10.0, 40.0)
    )
    kind = replace(CONVECTION, keys=(COEFFICIENT, inlet))
    (table,) = kind.temperatures(Given({"coefficient": 3.0, "inlet": 45.0}))
    assert (table(0.0), table(9.0)) == (45.0, 45.0)
    assert kind.temperatures(Given({})) == []


def test_examples_choose_from_usual_ranges():
    assert CONVECTION.example(max) == {"type": "convection", "coefficient": 5000.0, "ambient": 40.0}
    assert CONVECTION.example()["ambient"] == pytest.approx(20.0)
