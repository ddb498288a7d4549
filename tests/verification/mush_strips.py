"""Strips of mush that freeze evenly along x, as case files."""

from __future__ import annotations

from typing import Any

from tests.coupled_cases import merged

CONTRACTION, VISCOSITY, SPACING = 0.06, 1e-3, 50e-6
GRADIENT, SPEED, RANGE = 1e4, 1e-3, 50.0
LENGTH = RANGE / GRADIENT
"""Of the mush [m]: liquid fractions from 0 to 1."""
SOLIDUS = 500.0
DENSITY, CAPACITY, CONDUCTIVITY = 2500.0, 1000.0, 100.0
STIFF = 7e13
"""Young's modulus of a skeleton that suction does not compress [Pa]."""
METAL = {
    "density": DENSITY, "heat_capacity": CAPACITY, "conductivity": CONDUCTIVITY,
    "latent_heat": 0.0, "solidus": SOLIDUS, "liquidus": SOLIDUS + RANGE, "young_modulus": STIFF,
    "poisson_ratio": 0.3, "expansion": 0.0,
    "solidification_shrinkage": CONTRACTION / (1 + CONTRACTION), "melt_viscosity": VISCOSITY,
    "arm_spacing": SPACING,
}  # fmt: skip


def strip(
    *changes: dict[str, Any],
    size: float,
    step: float,
    end: float,
    length: float = LENGTH,
    cooling: float = GRADIENT * SPEED,
    ahead: float = 0.0,
    stretching: float = 0.0,
) -> dict[str, Any]:
    """Return a strip, one element wide, with an even gradient, fed at its hot end.

    Without latent heat an even sink keeps the gradient even.

    Args:
        changes: of the case.
        size: of the elements [m].
        step: its size [s].
        end: of the run [s].
        length: of the strip [m].
        cooling: rate of the temperature [K/s].
        ahead: of the solidus at the root at the start [K].
        stretching: rate of strain across the strip [1/s].
    """
    root = SOLIDUS + ahead
    flux = CONDUCTIVITY * GRADIENT
    stretched = [[0.0, 0.0], [1.0, stretching * size]] if stretching else 0.0
    held: dict[str, dict[str, Any]] = {
        "wall": {"displacement": {"x": 0.0}, "heat": {"type": "flux", "value": -flux}},
        "far": {"displacement": {"x": 0.0}, "heat": {"type": "flux", "value": flux}},
        "bottom": {"displacement": {"x": 0.0, "y": 0.0} if stretching else {"y": 0.0}},
        "top": {"displacement": {"x": 0.0, "y": stretched} if stretching else {"y": 0.0}},
    }
    table = [[0.0, root], [length, root + GRADIENT * length]]
    data = fed_strip(
        length, size, {"along": "x", "table": table}, cooling, held, step=step, end=end
    )
    for change in changes:
        data = merged(data, change)
    return data


def fed_strip(
    length: float,
    size: float,
    temperature: dict[str, Any],
    cooling: float,
    held: dict[str, dict[str, Any]],
    *,
    step: float,
    end: float,
) -> dict[str, Any]:
    """Return a strip, one element wide, that cools evenly and is fed at its far end.

    Args:
        length: of the strip [m].
        size: of the elements [m].
        temperature: at the start, as in a case.
        cooling: its rate [K/s].
        held: conditions of its sides, by name.
        step: its size [s].
        end: of the run [s].
    """
    return {
        "geometry": {"generator": "slab", "model": "plane-strain", "length": length,
                     "width": size, "size": size},
        "materials": {"alloy": METAL},
        "bodies": [
            {"name": "casting", "material": "alloy", "feeding": "darcy",
             "temperature": temperature, "heat_source": -DENSITY * CAPACITY * cooling},
        ],
        "boundaries": [{"on": f"casting/{name}", **what} for name, what in held.items()],
        "foundry": {"feeders": ["casting/far"]},
        "time": {"end": end, "first_step": step, "fixed_step": step, "largest_step": step},
        "coupling": {"scheme": "one-way"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-9},
    }  # fmt: skip


def skeleton(*changes: dict[str, Any], elements: int, history: list[list[float]]) -> dict[str, Any]:
    """Return a strip of one temperature, 10 mm long, held at its root and its sides.

    Its grains do not give, its skeleton has a shear modulus of 1 MPa.

    Args:
        changes: of the case.
        elements: along the strip.
        history: of its temperature, from 500 °C, all solid, to 600 °C, all liquid [s, °C].
    """
    length, ratio = 10e-3, 0.5 - 1e-11
    metal = METAL | {
        "latent_heat": 4e5, "liquidus": 600.0, "poisson_ratio": ratio,
        "young_modulus": 2e6 * (1 + ratio),
    }  # fmt: skip
    held = {"wall": "x", "bottom": "y", "top": "y"}
    data: dict[str, Any] = {
        "geometry": {"generator": "slab", "model": "plane-strain", "length": length,
                     "width": length / elements, "size": length / elements},
        "materials": {"alloy": metal},
        "bodies": [{"name": "casting", "material": "alloy", "feeding": "darcy",
                    "temperature_history": history}],
        "boundaries": [
            {"on": f"casting/{name}", "displacement": {axis: 0.0}} for name, axis in held.items()
        ],
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-12},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data
