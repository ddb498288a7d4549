"""V13: contact patch test, a stiff block on a soft one.

Two blocks of equal width, 30 and 20 mm high, under a pressure p, without friction, sides free: the
stress is σ_yy = -p in both, so the top of the base moves down by p h (1 - ν²)/E in plane strain.
R. L. Taylor and P. Papadopoulos (1991), On a patch test for contact problems in two dimensions.
"""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.proof.verification.states import cellwise, nodal, paired, places, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

PRESSURE, POISSON, WIDTH, HEIGHT, UPPER = 25e6, 0.33, 0.02, 0.02, 0.03
YOUNG = {"upper": 70e9, "base": 7e9}
SETTLING = -PRESSURE * HEIGHT * (1 - POISSON**2) / YOUNG["base"]
"""Displacement of the top of the base in plane strain [m]."""


def blocks_case(size: float, method: str) -> dict[str, Any]:
    """Return the case; its base is on rollers, and one side is a plane of symmetry."""
    return {
        "geometry": {"generator": "stacked_blocks", "model": "plane-strain", "size": size,
                     "upper": [WIDTH, UPPER], "base": [WIDTH, HEIGHT], "symmetry": True},
        "materials": {
            name: {"young_modulus": young, "poisson_ratio": POISSON, "expansion": 0.0}
            for name, young in YOUNG.items()
        },
        "bodies": [{"name": name, "material": name, "temperature": 20.0} for name in YOUNG],
        "interfaces": [{"bodies": ["upper", "base"], "contact": {"method": method}}],
        "boundaries": [
            {"on": "base/bottom", "displacement": {"normal": 0.0}},
            {"on": "upper/top", "pressure": PRESSURE},
        ],
        "time": {"end": 1.0, "fixed_step": 1.0},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-12},
    }  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Press the blocks by two methods that let nothing penetrate."""
    answers, worst = [], 0.0
    for method in ("condensed", "multipliers"):
        for state in states(comm, blocks_case(at.size, method)):
            points = {name: places(state, name) for name in YOUNG}
            moved = {name: nodal(state, name, "displacement")[:, 1] for name in YOUNG}
            pressures = paired(state, "upper/base", "contact_pressure")
            stress = np.concatenate([cellwise(state, name, "stress")[:, 1] for name in YOUNG])
        top = np.abs(points["base"][:, 1]) < 1e-9
        off = [
            np.abs(values / exact - 1).max()
            for values, exact in (
                (moved["base"][top], SETTLING), (pressures, PRESSURE), (stress, -PRESSURE),
            )
        ]  # fmt: skip
        names = ("settling of the base", "contact pressure", "stress")
        answers += [
            Answer.difference(f"{name}, {method}", error, "relative", 1e-8)
            for name, error in zip(names, off, strict=True)
        ]
        worst = max(worst, *off)
    order = {name: np.argsort(points[name][:, 1], kind="stable") for name in YOUNG}
    y = np.concatenate([points[name][order[name], 1] for name in ("base", "upper")])
    u = np.concatenate([moved[name][order[name]] for name in ("base", "upper")])
    shortened = SETTLING - PRESSURE * UPPER * (1 - POISSON**2) / YOUNG["upper"]
    curve = Curve("displacement", y, 1e6 * u, np.array([-HEIGHT, 0.0, UPPER]),
                  1e6 * np.array([0.0, SETTLING, shortened]))  # fmt: skip
    compared = Comparison("height above the interface [m]", "displacement [µm]", (curve,))
    return Outcome(tuple(answers), worst, compared)


VERIFICATION = Verification(
    number="V13",
    title="Contact patch test",
    formula="σ_yy = −p in both blocks, u = −p h (1 − ν²)/E at the top of the base",
    source="R. L. Taylor and P. Papadopoulos (1991), On a patch test for contact problems in two "
    "dimensions",
    run=compare,
    levels=(Resolution(0.005),),
    quick=(Resolution(0.005),),
    refined="nothing",
)
