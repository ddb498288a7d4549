"""Keys of the case file that several heat conditions use; one may declare keys of its own."""

from __future__ import annotations

from castx.input.entries import over_time
from castx.input.units import TEMPERATURE
from castx.tables import Table
from castx.transfer.declaration import HeatKey

AMBIENT: HeatKey[Table] = HeatKey(
    "ambient", "temperature of the surroundings", over_time(TEMPERATURE), usual=(10.0, 40.0)
)
