"""X13 and X14: a bar under a constant stress is heated while its hardening changes."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.verification.states import nodal, states

STRESS = 210e6
LENGTH = 0.01
YIELD = [[0.0, 200e6], [100.0, 30e6]]
ISOTROPIC = {"hardening": {"saturation": [[0.0, 100e6], [100.0, 270e6]],
                           "rate": [[0.0, 50.0], [100.0, 250.0]]}}  # fmt: skip
KINEMATIC = {"kinematic_hardening": [[0.0, 1e9], [100.0, 300e9]]}


def case(hardening: dict[str, Any], steps: int) -> dict[str, Any]:
    """Return the case: drawn from 0 to 1 s at 0 °C, heated to 100 °C from 1 to 2 s.

    Args:
        hardening: keys of the material.
        steps: of equal size for each second.
    """
    metal = {
        "density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0, "young_modulus": 2e11,
        "poisson_ratio": 0.3, "expansion": 1e-5, "stress_free": 0.0, "yield_stress": YIELD,
        **hardening,
    }  # fmt: skip
    return {
        "geometry": {"generator": "slab", "model": "plane-stress", "cells": "quadrilaterals",
                     "size": LENGTH, "length": LENGTH, "width": LENGTH},
        "materials": {"metal": metal},
        "bodies": [{"name": "casting", "material": "metal", "law": "thermo-elasto-plastic",
                    "temperature": 0.0, "formulation": "displacement",
                    "temperature_history": [[0.0, 0.0], [1.0, 0.0], [2.0, 100.0]]}],
        "boundaries": [
            {"on": "casting/wall", "displacement": {"normal": 0.0}},
            {"on": "casting/bottom", "displacement": {"normal": 0.0}},
            {"on": "casting/far", "pressure": [[0.0, 0.0], [1.0, -STRESS]]},
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": 2.0, "fixed_step": 1.0 / steps},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-10},
    }  # fmt: skip


def strains(
    comm: MPI.Intracomm, hardening: dict[str, Any], steps: int
) -> dict[float, float]:
    """Return the plastic part of the elongation by time."""
    found = {}
    for state in states(comm, case(hardening, steps)):
        T = max(state.time - 1.0, 0.0) * 100.0
        stress = STRESS * min(state.time, 1.0)
        elongation = nodal(state, "casting", "displacement")[:, 0].max() / LENGTH
        found[round(state.time, 6)] = float(elongation - stress / 2e11 - 1e-5 * T)
    return found


def isotropic(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return plastic strains at the start of heating, when they are largest and at the end."""
    found = strains(comm, ISOTROPIC, 20)
    kept = {1.0: 2.10721e-3, 1.45: 4.8108e-3, 2.0: 4.8108e-3}
    return tuple(
        Number.relative(f"plastic strain, {100 * (t - 1):g} °C", p, found[t], p, "1", 1e-5)
        for t, p in kept.items()
    )


def kinematic(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return plastic strains before it yields back, and after: (410 MPa − 1.7 T)/C(T)."""
    found = strains(comm, KINEMATIC, 20)
    back = {T: (410.0 - 1.7 * T) / (1e3 + 2990.0 * T) for T in (25.0, 50.0, 100.0)}
    exact = {0.0: 0.01, 10.0: 0.01, **back}
    kept = {0.0: 0.01, 100.0: 8.0e-4}
    return tuple(
        Number.relative(f"plastic strain, {T:g} °C", kept.get(T), found[round(1 + T / 100, 6)], p,
                        "1", 1e-5)
        for T, p in exact.items()
    )  # fmt: skip


CASES = (
    ForeignCase(
        number="X13",
        title="A bar under a constant stress whose isotropic hardening changes as it is heated",
        program="code_aster",
        path="HSNV124, V7.22.124, modelling of Voce's hardening (problem and solution)",
        exact="closed form, 210 MPa = σ_y(T) + Q(T) (1 − exp(−b(T) p)), largest near 45 °C",
        remark="The stress of 210 MPa follows from the times of the reference.",
        run=isotropic,
    ),
    ForeignCase(
        number="X14",
        title="The same bar with kinematic hardening, which yields back",
        program="code_aster",
        path="HSNV124, V7.22.124, modelling of linear kinematic hardening (problem and solution)",
        exact="closed form, |210 MPa − C(T) ε_p| = σ_y(T)",
        remark="From 12.658 °C on it yields in compression under tension.",
        run=kinematic,
    ),
)
