"""Heat condition `temperature`: the temperature of the surface is given over time."""

from __future__ import annotations

from castx.input.entries import over_time
from castx.input.units import TEMPERATURE
from castx.tables import Table
from castx.transfer.conditions.declaration import HeatConditionKind
from castx.transfer.declaration import Given, HeatKey

VALUE: HeatKey[Table] = HeatKey(
    "value", "temperature of the surface", over_time(TEMPERATURE), usual=(20.0, 300.0)
)


def temperature(given: Given) -> Table:
    """Return the temperature of the surface over time [°C]."""
    return given.need(VALUE)


CONDITION = HeatConditionKind(
    name="temperature",
    summary="The surface has a given temperature.",
    formula="T = value(t)",
    source="H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids (1959), section 1.9",
    keys=(VALUE,),
    temperature=temperature,
)
