"""X6: a bar held at both ends whose yield stress falls as it is heated."""

from __future__ import annotations

from mpi4py import MPI

from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.verification.solids.viscoplastic_bars import KINDS, bar
from castx.proof.verification.states import cellwise, states

EXACT = {66.6667: -400.0 / 3.0, 70.0: -125.0, 80.0: -100.0, 90.0: -75.0}
"""Stress [MPa] by temperature [°C]."""
YOUNG, TANGENT = 2e11, 5e10


def run(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return the stress at some temperatures; a second is a degree."""
    material = {
        "young_modulus": YOUNG, "poisson_ratio": 0.3, "expansion": 1e-5, "stress_free": 0.0,
        "yield_stress": [[0.0, 4e8], [99.9, 4e8 * (1 - 0.999)]],
        "hardening": {"linear": YOUNG * TANGENT / (YOUNG - TANGENT)},
    }  # fmt: skip
    warmed, held = [[0.0, 0.0], [90.0, 90.0]], [[0.0, 0.0]]
    case = bar(KINDS["generalised"], material, "thermo-elasto-plastic", warmed, held,
               end=90.0, steps=27)  # fmt: skip
    found = {
        round(state.time, 4): cellwise(state, "casting", "stress")[:, 0].mean()
        for state in states(comm, case)
    }
    return tuple(
        Number.relative(f"stress at {T:g} °C", 1e6 * stress, found[round(T, 4)], 1e6 * stress,
                        "Pa", 1e-5)
        for T, stress in EXACT.items()
    )  # fmt: skip


CASES = (
    ForeignCase(
        number="X6",
        title="A heated bar whose yield stress falls",
        program="code_aster",
        path="HSNV100, V7.22.100 (reference problem)",
        exact="closed form of linear hardening along the path",
        remark="The reference is the closed form.",
        run=run,
    ),
)
