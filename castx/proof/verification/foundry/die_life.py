"""F6: strain and life of a die surface, beside the curve that the life inverts.

Δε/2 = (σ_f′/E)(2N)^b + ε_f′ (2N)^c gives the strain of a life at once; the life of a strain has no
closed form, and is found here by bracketing. A surface that may not expand in its plane is strained
by α ΔT/(1 − ν), from σ_x = σ_y and Hooke's law.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.foundry.die_life import Fatigue, restrained_strain, strain_range
from castx.proof.verification.verification import (
    MESHLESS,
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

STEEL, YOUNG, POISSON = Fatigue(2000e6, -0.08, 0.4, -0.65), 205e9, 0.29
EXPANSION, RISE = 12.5e-6, 300.0
RANGES = (0.004, 0.008, 0.012, 0.03)


def strain_of(cycles: FloatArray) -> FloatArray:
    """Return the strain range of a life."""
    twice = 2 * np.asarray(cycles)
    elastic = STEEL.strength / YOUNG * twice**STEEL.strength_exponent
    return np.asarray(2 * (elastic + STEEL.ductility * twice**STEEL.ductility_exponent))


def cycles_of(strain: float) -> float:
    """Return the life of a strain range."""

    def over(power: float) -> float:
        return float(np.log(strain_of(np.array(10.0**power)) / strain))

    return float(10.0 ** brentq(over, -2.0, 30.0, xtol=1e-14, rtol=1e-14))


def restrained() -> float:
    """Return the stress over E by which a heated surface is pressed that may not expand.

    ε_x = (σ_x − ν σ_y)/E + α ΔT = 0, and the same in y.
    """
    hooke = np.array([[1.0, -POISSON], [-POISSON, 1.0]])
    return float(-np.linalg.solve(hooke, np.full(2, -EXPANSION * RISE))[0])


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Evaluate the functions beside their solutions."""
    names = [f"strain range {strain:g}" for strain in RANGES]
    found = STEEL.cycles(np.array(RANGES), YOUNG)
    strain = float(restrained_strain(EXPANSION, np.array(RISE), POISSON))
    parts = strain_range(np.array([410e6]), np.array([1e-3]), np.array([YOUNG]))[0]
    answers = (
        *Answer.rows("cycles to a crack", {name: float(found[k]) for k, name in enumerate(names)},
                     {name: cycles_of(value) for name, value in zip(names, RANGES, strict=True)},
                     "", 1e-9),
        Answer.relative("strain of a restrained surface, heated by 300 K", strain,
                        restrained(), "", 1e-12),
        Answer.relative("stress of this surface", YOUNG * strain, YOUNG * restrained(), "Pa",
                        1e-12),
        Answer.relative("range of 410 MPa and a plastic strain of 0.001", parts,
                        410 / 205e3 + 1e-3, "", 1e-12),
    )  # fmt: skip
    lives: FloatArray = np.logspace(1.0, 7.0, 31, dtype=np.float64)
    strains = strain_of(lives)
    curve = Curve("life", np.log10(strains), np.log10(STEEL.cycles(strains, YOUNG)),
                  np.log10(strains), np.log10(lives))  # fmt: skip
    return Outcome(
        answers,
        max(answer.error for answer in answers),
        Comparison("log10 of the strain range", "log10 of the cycles to a crack", (curve,)),
    )


VERIFICATION = Verification(
    number="F6",
    title="Life of a die surface",
    formula="Δε/2 = (σ_f′/E)(2N)^b + ε_f′ (2N)^c; restrained in its plane α ΔT/(1 − ν)",
    source="S. S. Manson and G. R. Halford, Fatigue and Durability of Structural Materials (2006), "
    "ch. 3; Hooke's law",
    run=compare,
    levels=MESHLESS,
    quick=MESHLESS,
    refined="nothing",
)
