"""V21: contraction of a plate while it freezes from its wall.

Plate 0 ≤ x ≤ L of metal that freezes at T_m, at T_m at the start, insulated and symmetric at x = L,
cooled at x = 0 by h (T_m − ΔT). With lengths in L, times in L²/a and temperatures over T_m in ΔT,

    ∂H/∂t = ∂²T/∂x²,   H = T + f_l/Ste,   ∂T/∂x = Bi (T + 1) at x = 0,   Ste = c ΔT/latent heat.

What is frozen is elastic, new solid is born free of stress, nothing bends and no force acts along
the plate. Layers of thickness dx thus have, with f the share of them that is solid,

    dσ = M (f dε − α d(T f̄)),   ∫ σ dx = 0,   so that dε = α ∫ dT dx/∫ f dx

while they freeze, T = 0 in the liquid. Where both lateral directions move alike ε is that; where
one of them is held, plane strain, ε is 1 + ν times as much. There is no closed form: the reference
follows the front (`freezing_front`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.process.state import State
from castx.proof.verification.solids.freezing_front import FreezingFront
from castx.proof.verification.states import nodal, places, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

LENGTH, SPAN, MELTING = 0.01, 200.0, 660.0
CONDUCTIVITY, DENSITY, CAPACITY = 100.0, 2700.0, 1000.0
EXPANSION, POISSON, YOUNG = 2e-5, 0.33, 30e9
SECOND = CONDUCTIVITY / (DENSITY * CAPACITY * LENGTH**2)
"""Dimensionless time in a second."""


@dataclass(frozen=True)
class Plate:
    """A plate and the time in which three quarters of it freeze.

    Attributes:
        biot: h L/k.
        end: a t/L².
        steps: equal ones until then.
        stefan: Ste.
    """

    biot: float
    end: float
    steps: int = 200
    stefan: float = 1.63


PLATES = {
    "thin wall": Plate(0.13, 4.0, 400),
    "die": Plate(1.0, 0.7),
    "chill": Plate(4.0, 1.2, 600),
}
MESHES = {
    "triangles": ("plane-strain", "simplices"),
    "quadrilaterals": ("plane-strain", "quadrilaterals"),
    "tetrahedra": ("3d", "simplices"),
}


@cache
def reference(plate: Plate) -> tuple[FloatArray, FloatArray]:
    """Return times over the end and lateral strains over α ΔT, both (plate.steps + 1,)."""
    times = np.linspace(0.0, 1.0, plate.steps + 1, dtype=np.float64)
    return times, FreezingFront(plate.biot, plate.stefan).strains(times * plate.end)


def free_plate(
    model: str, kind: str, length: float, cells: int, cooling: dict[str, Any]
) -> dict[str, Any]:
    """Return geometry and boundaries of a plate that contracts evenly along itself.

    Args:
        model: geometric model.
        kind: of its cells.
        length: across the plate [m].
        cells: across it.
        cooling: heat condition of its wall.
    """
    size = length / cells
    geometry: dict[str, Any] = {
        "generator": "slab", "model": model, "cells": kind,
        "length": length, "width": 2 * size, "size": size,
    }  # fmt: skip
    lateral = {"bottom": "top"}
    if model == "3d":
        geometry["depth"] = geometry["width"] = size
        lateral["back"] = "front"
    boundaries: list[dict[str, Any]] = [
        {"on": "casting/wall", "heat": cooling},
        {"on": "casting/far", "displacement": {"normal": 0.0}},
    ]
    for held, free in lateral.items():
        boundaries.append({"on": f"casting/{held}", "displacement": {"normal": 0.0}})
        boundaries.append({"on": f"casting/{free}", "displacement": {"normal": "uniform"}})
    return {"geometry": geometry, "boundaries": boundaries}


def plate_case(plate: Plate, model: str, kind: str, cells: int) -> dict[str, Any]:
    """Return the case with this number of cells across the plate."""
    coefficient = plate.biot * CONDUCTIVITY / LENGTH
    cooling = {"type": "convection", "coefficient": coefficient, "ambient": MELTING - SPAN}
    metal = {
        "density": DENSITY, "heat_capacity": CAPACITY, "conductivity": CONDUCTIVITY,
        "latent_heat": CAPACITY * SPAN / plate.stefan, "solidus": MELTING, "liquidus": MELTING,
        "young_modulus": YOUNG, "poisson_ratio": POISSON, "expansion": EXPANSION,
        "liquid": {"viscosity": 1e5, "coherency": 0.5},
    }  # fmt: skip
    end = plate.end / SECOND
    return {
        **free_plate(model, kind, LENGTH, cells, cooling),
        "materials": {"metal": metal},
        "bodies": [{"name": "casting", "material": "metal", "temperature": MELTING + 1e-3,
                    "law": "thermo-elastic"}],
        "time": {"end": end, "fixed_step": end / plate.steps},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-6},
    }  # fmt: skip


def contraction(run: Iterable[State], data: dict[str, Any]) -> FloatArray:
    """Return the lateral strain over α ΔT, as if both directions were free, (steps + 1,)."""
    width, found = data["geometry"]["width"], []
    for state in run:
        top = np.isclose(places(state, "casting")[:, 1], width)
        found.append(nodal(state, "casting", "displacement")[top, 1].mean() / width)
    held = 1.0 + POISSON if data["geometry"]["model"] == "plane-strain" else 1.0
    return np.asarray(np.array(found) / (EXPANSION * SPAN * held))


SETTLED = 0.15
"""Share of the time from which the error counts: before, the skin is within a cell or two."""


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Run all plates on triangles and compare."""
    answers, errors, curves = [], [], []
    for name, plate in PLATES.items():
        data = plate_case(plate, *MESHES["triangles"], round(LENGTH / at.size))
        time, exact = reference(plate)
        found = contraction(states(comm, data), data)
        bounds = {"half of the time": 0.02, "the end": 0.015}
        if name != "thin wall":
            bounds = {"half of the time": 0.03, "the end": 0.02}
        for (when, bound), index in zip(bounds.items(), (plate.steps // 2, -1), strict=True):
            answers.append(
                Answer.relative(
                    f"contraction over α ΔT, {name}, {when}", found[index], exact[index], "", bound
                )
            )
        errors.append((found - exact)[time >= SETTLED] / exact[-1])
        curves.append(Curve(name, time, found, time, exact))
    return Outcome(
        tuple(answers),
        float(np.sqrt(np.mean(np.square(errors[0])))),
        Comparison("time over the end", "lateral strain over α ΔT", tuple(curves)),
    )


VERIFICATION = Verification(
    number="V21",
    title="Contraction of a freezing plate",
    formula="∂H/∂t = ∂²T/∂x², H = T + f_l/Ste, ∂T/∂x = Bi (T + 1) at the wall; "
    "dε = α ∫dT dx/∫f dx, as new solid is born free of stress",
    source="solution of its own in coordinates that follow the front (H. G. Landau, 1950), to "
    "1e-7; Ste = 1.63, Bi = 0.13, 1 and 4",
    run=compare,
    levels=tuple(Resolution(LENGTH / n) for n in (8, 16, 32)),
    quick=tuple(Resolution(LENGTH / n) for n in (8, 16)),
    norm="root mean square of the error of the thin wall (Bi = 0.13) from 15 % of the time on, "
    "over its contraction",
)
