"""V11: viscoplastic bars, cooled or stretched at constant length.

In uniaxial stress, held or moved at their ends, sides free: along x in plane stress, in generalised
plane strain (the resultant of the third direction is zero) and in space, along z as an axisymmetric
rod.

Maxwell: Bingham flow without yield stress, ε̇_vp = σ/(3η), length held, cooled at Ṫ:
σ = 3ηαṪ (1 − exp(−E t/(3η))).
Norton relaxation at constant length, ε̇_vp = A σⁿ: σ^(1−n) = σ0^(1−n) + (n − 1) E A t.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.proof.verification.states import cellwise, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

VISCOPLASTIC = "thermo-elasto-viscoplastic"
YOUNG, VISCOSITY, EXPANSION, COOLING = 50e9, 200e9, 2.4e-5, 2.0
MAXWELL = {
    "young_modulus": YOUNG, "poisson_ratio": 0.3, "expansion": EXPANSION, "law": "bingham",
    "yield_stress": 0.0, "viscosity": VISCOSITY,
}  # fmt: skip
CREEPING, COEFFICIENT, EXPONENT, START = 60e9, 1e-40, 5.0, 80e6
NORTON = {
    "young_modulus": CREEPING, "poisson_ratio": 0.35, "expansion": 0.0, "law": "norton",
    "coefficient": COEFFICIENT, "exponent": EXPONENT,
}  # fmt: skip
LENGTH = 0.04


class Kind(NamedTuple):
    """Model, cells and formulation of a bar."""

    model: str
    formulation: str = "mixed"
    stabilisation: str = "osgs"
    cells: str = "simplices"


KINDS = {
    "plane stress": Kind("plane-stress", "displacement"),
    "plane stress quadrilaterals": Kind("plane-stress", "displacement", cells="quadrilaterals"),
    "generalised": Kind("generalised-plane-strain"),
    "generalised displacement": Kind("generalised-plane-strain", "displacement"),
    "generalised q1p0": Kind("generalised-plane-strain", "q1p0", cells="quadrilaterals"),
    "axisymmetric": Kind("axisymmetric", stabilisation="gls"),
    "axisymmetric displacement": Kind("axisymmetric", "displacement"),
    "axisymmetric q1p0": Kind("axisymmetric", "q1p0", cells="quadrilaterals"),
    "space": Kind("3d"),
    "space displacement": Kind("3d", "displacement"),
    "space q1p0": Kind("3d", "q1p0", cells="quadrilaterals"),
}


def bar(
    kind: Kind, material: Mapping[str, Any], law: str, temperatures: Any, strains: Any,
    *, end: float, steps: int,
) -> dict[str, Any]:  # fmt: skip
    """Return the case.

    Args:
        kind: model, cells and formulation.
        material: mechanical properties.
        law: of the body.
        temperatures: table over time [°C].
        strains: table over time of the elongation over the length.
        end: of the run [s].
        steps: of equal size.
    """
    rod = kind.model == "axisymmetric"
    size = {"length": 0.01, "width": LENGTH} if rod else {"length": LENGTH, "width": 0.01}
    if kind.model == "3d":
        size["depth"] = 0.01
    near, far, *rest = ("bottom", "top") if rod else ("wall", "far", "bottom", "back")
    rest = [] if rod else rest[: 2 if kind.model == "3d" else 1]
    moved = [[time, LENGTH * strain] for time, strain in strains]
    return {
        "geometry": {"generator": "slab", "model": kind.model, "cells": kind.cells,
                     "size": 0.01, **size},
        "materials": {"metal": {"density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0,
                                **material}},
        "bodies": [{"name": "casting", "material": "metal", "law": law,
                    "temperature": temperatures[0][1], "temperature_history": temperatures,
                    "formulation": kind.formulation, "stabilisation": kind.stabilisation}],
        "boundaries": [
            *({"on": f"casting/{s}", "displacement": {"normal": 0.0}} for s in (near, *rest)),
            {"on": f"casting/{far}", "displacement": {"z" if rod else "x": moved}},
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": end, "fixed_step": end / steps},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-11},
    }  # fmt: skip


def maxwell(kind: Kind, end: float, steps: int) -> dict[str, Any]:
    """Return the case of a bar that is held and cooled."""
    cooled = [[0.0, 500.0], [end, 500.0 - COOLING * end]]
    held = [[0.0, 0.0]]
    return bar(kind, MAXWELL, VISCOPLASTIC, cooled, held, end=end, steps=steps)


def norton(kind: Kind, end: float, steps: int) -> dict[str, Any]:
    """Return the case of a bar that is stretched at once and relaxes."""
    warm, stretched = [[0.0, 500.0]], [[0.0, START / CREEPING]]
    return bar(kind, NORTON, VISCOPLASTIC, warm, stretched, end=end, steps=steps)


def exact_maxwell(time: float) -> float:
    """Return the stress of the cooled bar [Pa]."""
    limit = 3 * VISCOSITY * EXPANSION * COOLING
    return float(limit * -np.expm1(-YOUNG * time / (3 * VISCOSITY)))


def exact_norton(time: float) -> float:
    """Return the stress of the stretched bar [Pa]."""
    m = 1 - EXPONENT
    return float((START**m - m * CREEPING * COEFFICIENT * time) ** (1 / m))


CASES = (
    ("Maxwell, cooled", maxwell, exact_maxwell, 20.0),
    ("Norton, relaxing", norton, exact_norton, 100.0),
)


def history(comm: MPI.Intracomm, case: Mapping[str, Any]) -> FloatArray:
    """Return shares of the time and the stress along x after each step, shape (2, steps)."""
    end = case["time"]["end"]
    rows = [
        (state.time / end, cellwise(state, "casting", "stress")[:, 0].mean())
        for state in states(comm, case)
        if state.step > 0
    ]
    return np.array(rows, dtype=np.float64).T


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Cool one bar and stretch the other; the step is a share of the time."""
    answers, curves, norm = [], [], 0.0
    for what, case, solution, end in CASES:
        time, stress = history(comm, case(KINDS["generalised"], end, round(1 / at.step)))
        exact = np.array([solution(end * t) for t in time])
        answers.append(Answer.relative(what, stress[-1], exact[-1], "Pa", 5e-3))
        norm = max(norm, float(np.abs(stress[-1] / exact[-1] - 1)))
        line = fine(0.0, 1.0)
        solved = 1e-6 * np.array([solution(end * t) for t in line])
        curves.append(Curve(what, time, 1e-6 * stress, line, solved))
    compared = Comparison("time over that of the end", "stress [MPa]", tuple(curves))
    return Outcome(tuple(answers), norm, compared)


VERIFICATION = Verification(
    number="V11",
    title="Viscoplastic bars",
    formula="Maxwell σ = 3ηαṪ (1 − exp(−E t/(3η))); Norton σ^(1−n) = σ0^(1−n) + (n − 1) E A t",
    source="the rate equations ε̇_vp = σ/(3η) and ε̇_vp = A σⁿ at constant length, integrated",
    run=compare,
    levels=tuple(Resolution(0.01, 1 / steps) for steps in (100, 200, 400)),
    quick=tuple(Resolution(0.01, 1 / steps) for steps in (50, 100)),
    refined="step",
    norm="larger relative error of both stresses at the end",
)
