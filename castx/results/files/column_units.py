"""Units of the columns of history.csv."""

from __future__ import annotations

from castx.meshes.generators.declaration import PLANE_MODELS

UNITS = {
    "time": "s", "step": "s", "wall": "s",
    "enthalpy": "J", "heat_in": "J", "heat": "J", "power": "W",
    "dissipation": "J", "source": "J", "renewal": "J",
    "feeding_demand": "m³", "fed_volume": "m³", "opened_volume": "m³", "yielded_volume": "m³",
    "unfed_volume": "m³", "pipe_volume": "m³",
    "pocket_pressure": "Pa", "melt_suction": "Pa", "suction": "Pa",
    "feeder_level": "m", "level_drop": "m",
    "mean_gap": "m", "min_gap": "m", "max_gap": "m", "clamp_displacement": "m",
    "force": "N", "ejection_force": "N", "clamp_force": "N", "support_force": "N",
    "largest_pull": "N", "support_moment": "N m",
    "min_temperature": "°C", "mean_temperature": "°C", "max_temperature": "°C",
    "temperature_error": "K", "gap_error": "m",
}  # fmt: skip
"""Units of the quantities of history.csv; the others are numbers and shares."""
PER_DEPTH = ("J", "W", "m³", "N", "N m")
"""Units of what a plane model has for a metre of depth."""


def quantity_of(column: str) -> str:
    """Return the quantity of a column of history.csv: "force" of "casting/mould.force.z".

    Surfaces that are bare in a stage have the names of interfaces: "casting/mould.surface.heat".
    """
    owner, _, rest = column.partition(".")
    return (rest or owner).removeprefix("surface.").partition(".")[0]


def unit_of(column: str, model: str) -> str:
    """Return the unit of a column of history.csv, "1" of numbers and shares.

    Args:
        column: its name, such as "casting/mould.force.z".
        model: the geometric model; plane ones have what adds up per metre of depth.
    """
    unit = UNITS.get(quantity_of(column), "1")
    return f"{unit}/m" if model in PLANE_MODELS and unit in PER_DEPTH else unit
