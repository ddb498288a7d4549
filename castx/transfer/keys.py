"""Keys of the case file that several gap heat laws use; a law may declare keys of its own."""

from __future__ import annotations

from castx.input.entries import Quantity
from castx.input.units import CONDUCTIVITY, HEAT_TRANSFER, LENGTH
from castx.input.variation import Variation, Varying
from castx.transfer.declaration import HeatKey
from castx.transfer.surfaces import Coating, ContactConductance, CurvedGap, Radiation, Roughness

_COEFFICIENT = Varying(
    Quantity(HEAT_TRANSFER, above=0.0),
    ("temperature", "time", "gap", "pressure"),
    ("secondary", "primary", "mean"),
    ends_at_zero=("gap",),
)
_GAS = Varying(
    Quantity(CONDUCTIVITY, above=0.0), ("temperature", "time"), ("mean", "secondary", "primary")
)

CLOSED: HeatKey[Variation] = HeatKey(
    "closed",
    "coefficient of touching surfaces without pressure",
    _COEFFICIENT,
    usual=(100.0, 50_000.0),
)
OPEN: HeatKey[Variation] = HeatKey(
    "open", "coefficient of the open gap", _COEFFICIENT, usual=(20.0, 100.0)
)
GAS_CONDUCTIVITY: HeatKey[Variation] = HeatKey(
    "gas_conductivity", "conductivity of the gas in gap and roughness", _GAS, usual=(0.02, 0.3)
)
TRANSITION: HeatKey[float] = HeatKey(
    "transition",
    "width of gaps over which the bend of the law is rounded",
    Quantity(LENGTH, above=0.0),
    usual=(1e-6, 1e-4),
    default=0.0,
)
PRESSURE: HeatKey[ContactConductance] = HeatKey(
    "pressure",
    "what contact pressure adds: resistance [m^2*K/W], hardness [Pa], exponent",
    ContactConductance | None,
    usual={"resistance": (2e-5, 2e-3), "hardness": 5e8, "exponent": 0.95},
)
ROUGHNESS: HeatKey[tuple[float, ...]] = HeatKey(
    "roughness",
    "peak-to-valley heights of both surfaces [m]",
    Roughness | None,
    usual=[(5e-6, 5e-5), (5e-6, 5e-5)],
)
COATING: HeatKey[Coating] = HeatKey(
    "coating",
    "layer on the mould: thickness [m], conductivity [W/m/K]",
    Coating | None,
    usual={"thickness": (5e-5, 5e-4), "conductivity": (0.2, 2.0)},
)
RADIATION: HeatKey[Radiation] = HeatKey(
    "radiation",
    "across the gap: emissivities of both surfaces",
    Radiation | None,
    usual={"emissivities": [(0.2, 0.9), (0.2, 0.9)]},
)
CURVED: HeatKey[CurvedGap] = HeatKey(
    "curved",
    "wide gap of concentric cylinders or spheres: shape, radii of both surfaces [m]",
    CurvedGap | None,
    usual={"shape": "cylinder", "radii": [(0.05, 0.1), (0.11, 0.2)]},
)
ROUGH: tuple[HeatKey[object], ...] = (ROUGHNESS, COATING)
"""Keys that give the resistance of touching surfaces in place of `closed`."""
