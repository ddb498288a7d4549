"""Heat condition `temperature`: that of the surface is given over time and from place to place."""

from __future__ import annotations

from castx.input.entries import Quantity
from castx.input.located import OverTime
from castx.input.placed import PlacedOverTime
from castx.input.units import TEMPERATURE
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.declaration import Given, HeatKey

VALUE: HeatKey[OverTime] = HeatKey(
    "value",
    "temperature of the surface",
    PlacedOverTime(Quantity(TEMPERATURE)),
    usual=(20.0, 300.0),
)


def temperature(given: Given) -> OverTime:
    """Return the temperature of the surface over time [°C]."""
    return given.need(VALUE)


CONDITION = HeatConditionKind(
    name="temperature",
    summary="The surface has a given temperature.",
    formula="T = value(x, t)",
    source="H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids (1959), section 1.9",
    keys=(VALUE,),
    temperature=temperature,
)
