"""V6: the solidification time of plates in a sand mould grows with (V/A)².

With perfect contact and sand that is thick enough, plates of the same superheat have similar
temperature fields in x/d and t/d², so that t/(V/A)² is one number for all thicknesses d.
N. Chvorinov, Die Giesserei 27 (1940) 177.
"""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.modulus import PouredMetal, SandMould, mould_constant
from castx.proof.verification.heat.schwarz import two_strips
from castx.proof.verification.states import profile, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

THICKNESSES = (10e-3, 20e-3, 40e-3)
LATENT, MELTING, START, SAND = 9.5e8, 660.0, 700.0, 20.0
METAL: dict[str, Any] = {
    "density": 1.0, "heat_capacity": {"solid": 2.9e6, "liquid": 2.6e6},
    "conductivity": {"solid": 210.0, "liquid": 95.0}, "latent_heat": LATENT,
    "solidus": MELTING, "liquidus": MELTING,
}  # fmt: skip
MOULD: dict[str, Any] = {"density": 1.0, "heat_capacity": 1.76e6, "conductivity": 0.6}


def rough_time(half: float) -> float:
    """Return Chvorinov's time of half a plate without superheat [s]; it sets steps and depth."""
    sand = SandMould(MOULD["conductivity"], MOULD["heat_capacity"], SAND)
    metal = PouredMetal(LATENT, METAL["heat_capacity"]["liquid"], MELTING, MELTING, MELTING)
    return mould_constant(metal, sand) * half**2


def sand_depth(half: float, size: float) -> float:
    """Return a depth of sand whose outside stays cold, in whole elements [m]."""
    diffusivity = MOULD["conductivity"] / MOULD["heat_capacity"]
    return float(size * np.ceil(8 * np.sqrt(diffusivity * rough_time(half)) / size))


def solidification(
    comm: MPI.Intracomm, thickness: float, at: Resolution
) -> tuple[FloatArray, FloatArray, float]:
    """Return times [s] and solid fractions of a plate, and how much the outside of the sand warmed.

    Args:
        comm: the ranks.
        thickness: of the plate; half of it is meshed [m].
        at: size, and step over the rough time.
    """
    half = thickness / 2
    expected = rough_time(half)
    case = two_strips(
        METAL, MOULD, {"law": "perfect"}, Resolution(at.size, at.step * expected),
        lengths=(half, sand_depth(half, at.size)), temperatures=(START, SAND), end=2 * expected,
    )  # fmt: skip
    rows, warmed = [(0.0, 0.0)], 0.0
    for state in states(comm, case):
        rows.append((state.time, state.totals["casting.solid_fraction"]))
        warmed = float(profile(state, "mould", "temperature")[1][0] - SAND)
        if rows[-1][1] > 1 - 1e-9:
            break
    times, fractions = np.array(rows[1:]).T
    return times, fractions, warmed


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Let three plates freeze and compare their times over (V/A)²."""
    half = np.array(THICKNESSES) / 2
    runs = [solidification(comm, thickness, at) for thickness in THICKNESSES]
    constants = np.array([times[-1] for times, *_ in runs]) / half**2
    mean = float(constants.mean())
    # Times of all are whole steps; of nine tenths they are smooth in size and step.
    most = np.array([np.interp(0.9, fractions, times) for times, fractions, _ in runs]) / half**2
    names = [f"{1e3 * thickness:g} mm" for thickness in THICKNESSES]
    curves = tuple(
        Curve(f"plate of {name}", times / h**2, fractions, runs[-1][0] / half[-1] ** 2, runs[-1][1])
        for name, (times, fractions, _), h in zip(names, runs, half, strict=True)
    )
    return Outcome(
        (
            *(
                Answer.relative(f"time over (V/A)², {name}", constant, mean, "s/m²", 0.05)
                for name, constant in zip(names, constants, strict=True)
            ),
            *(
                Answer.difference(f"warming of the outside of the sand, {name}", warmed, "K", 0.5)
                for name, (*_, warmed) in zip(names, runs, strict=True)
            ),
        ),
        float(np.abs(most / most.mean() - 1).max()),
        Comparison("time over (V/A)² [s/m²]", "solid fraction", curves),
    )


VERIFICATION = Verification(
    number="V6",
    title="Plates in a sand mould",
    formula="t_s ~ (V/A)²: temperature fields are similar in x/d and t/d²; exact curve: the "
    "thickest plate",
    source="N. Chvorinov, Die Giesserei 27 (1940) 177",
    run=compare,
    levels=(Resolution(2e-3, 0.02), Resolution(1e-3, 0.01), Resolution(0.5e-3, 0.005)),
    quick=(Resolution(2e-3, 0.02), Resolution(1e-3, 0.01)),
    norm="largest deviation of the time of 90 % solid over (V/A)² from the mean",
)
