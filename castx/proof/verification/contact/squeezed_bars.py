"""V15: penalty and multipliers in closed form.

Two bars, ν = 0, squeezed by d between their far ends. The pressure is p = d/(L1/E1 + L2/E2 + 1/ε)
with a penetration of p/ε; without penetration p = d/(L1/E1 + L2/E2).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.proof.verification.contact.stacked import over_penalties, stacked_case
from castx.proof.verification.states import paired, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Outcome,
    Resolution,
    Verification,
)

LENGTH, SQUEEZE = 0.05, 1e-4
YOUNG = {"upper": 7e9, "base": 70e9}
COMPLIANCE = sum(LENGTH / E for E in YOUNG.values())
PENALTIES = (1e10, 1e11, 1e12, 1e13, 1e14)


def pressure(penalty: float = np.inf) -> float:
    """Return the contact pressure under a penalty ε [Pa/m]; without end for no penetration."""
    return SQUEEZE / (COMPLIANCE + 1 / penalty)


def bars_case(size: float, contact: Mapping[str, Any]) -> dict[str, Any]:
    """Return the case of two bars whose far ends move towards each other."""
    bars = dict.fromkeys(YOUNG, (0.02, LENGTH))
    return stacked_case(size, bars, YOUNG, 0.0, SQUEEZE, contact)


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Squeeze the bars under several penalties and without penetration."""
    answers, found, worst = [], [], 0.0
    exact = {f"{value:g}": value for value in PENALTIES}
    methods: dict[str, dict[str, Any]] = {
        name: {"method": "penalty", "penalty": value} for name, value in exact.items()
    }
    methods |= {name: {"method": name} for name in ("condensed", "multipliers")}
    for name, contact in methods.items():
        penalty = exact.get(name, np.inf)
        for state in states(comm, bars_case(at.size, contact)):
            pressures = paired(state, "upper/base", "contact_pressure")
            gaps = paired(state, "upper/base", "gap")
        off = float(np.abs(pressures / pressure(penalty) - 1).max())
        sunk = float(np.abs(gaps + pressure(penalty) / penalty).max()) / SQUEEZE
        what = f"penalty {name} Pa/m" if name in exact else name
        answers += [
            Answer.difference(f"pressure, {what}", off, "relative", 1e-8),
            Answer.difference(f"penetration over the squeeze, {what}", sunk, "", 1e-8),
        ]
        worst = max(worst, off)
        found.append(float(pressures.mean()))
    soft = found[: len(PENALTIES)]
    curve = over_penalties("contact pressure", PENALTIES, soft, pressure, 1e-6)
    compared = Comparison("log10 of the penalty [Pa/m]", "contact pressure [MPa]", (curve,))
    return Outcome(tuple(answers), worst, compared)


VERIFICATION = Verification(
    number="V15",
    title="Two squeezed bars: penalty, multipliers and condensed contact",
    formula="p = d/(L1/E1 + L2/E2 + 1/ε), penetration p/ε; without penetration "
    "p = d/(L1/E1 + L2/E2)",
    source="bars and springs in series",
    run=compare,
    levels=(Resolution(0.01),),
    quick=(Resolution(0.01),),
    refined="nothing",
)
