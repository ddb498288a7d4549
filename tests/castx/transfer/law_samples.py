"""Heat-transfer laws at numbers, and samples of every registered law."""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from castx.case.heat_transfer import InterfaceHeat
from castx.input.variation import Varying
from castx.transfer.conductance import Conductance, Faces
from castx.transfer.declaration import GapHeatLaw, HeatKey
from castx.transfer.pair_state import PairState
from castx.transfer.registry import gap_heat_laws

PRESSURE = {"resistance": 1.6666667e-5, "hardness": "1.2 GPa", "exponent": 0.95}
LIMITED = {"law": "limited", "closed": 800, "gas_conductivity": 0.04}
SERIES = {**LIMITED, "law": "series"}
ROUGH = {
    "law": "series", "gas_conductivity": 0.04, "roughness": ["30 um", "40 um"],
    "coating": {"thickness": "100 um", "conductivity": 0.5},
}  # fmt: skip
FALLING = {"over": "temperature", "table": [[100, 900], [300, 1500], [600, 600]]}
GAS = {"over": "temperature", "table": [[0, 0.025], [1000, 0.07]]}
BY_GAP = {"over": "gap", "table": [[0, 800], ["100 um", 300], ["1 mm", 40]]}
BY_PRESSURE = {"over": "pressure", "table": [[0, 800], ["10 MPa", 5000]]}
CONDUCTING = [name for name, law in gap_heat_laws().items() if law.exchange == "law"]


def conductance(
    heat, gap=0.0, pressure=0.0, secondary=500.0, primary=200.0, time=0.0, solid=0.3
) -> Conductance:
    """Return the conductance of a law at numbers or arrays of one length."""
    values = np.broadcast_arrays(*(np.atleast_1d(v).astype(float) for v in (gap, pressure)))
    hot, cold = (np.broadcast_to(v, values[0].shape).astype(float) for v in (secondary, primary))
    faces = Faces.at_temperatures(hot, cold, time, solid)
    return InterfaceHeat.read(heat).conduction_law()(PairState.of(*values), faces)


def coefficient(heat, *arguments, **named) -> np.ndarray:
    return conductance(heat, *arguments, **named).coefficient.value


def varying(law: GapHeatLaw) -> dict[str, Any]:
    """Return a law whose coefficients fall from 100 to 900 °C through their usual ranges."""
    return law.example() | {key.name: falling(key) for key in law.needed if over_temperature(key)}


def over_temperature(key: HeatKey[object]) -> bool:
    entry = key.entry
    return isinstance(entry, Varying) and "temperature" in (key.over or entry.over)


def falling(key: HeatKey[Any]) -> dict[str, Any]:
    low, high = cast("tuple[float, float]", key.usual)
    return {"over": "temperature", "table": [[100, high], [900, low]], "of": "mean"}
