"""F5: stress and shape of a cold part, beside solutions by hand.

Three bars: no force on the whole and equal lengths are two linear equations for two stresses. A
free contraction by e leaves −e R on a sphere; a mould corrected by what is left of it −e² of the
size, corrected again −e³. A parabola of curvature κ over a length L is flat to κ L²/8, a bore
r = R + δ cos mφ round to 2δ.
"""

from __future__ import annotations

from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.cracking import three_bar_stresses
from castx.foundry.distortion import allowance, best_fit, compensated, normal_deviation
from castx.foundry.roundness import flatness, roundness
from castx.proof.verification.verification import (
    MESHLESS,
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

CONTRACTION = 25.5e-6 * 537.0
RADIUS, LOBE = 50e-3, 20e-6
CURVATURE, SPAN = 0.3, 0.2


@dataclass(frozen=True)
class Frame:
    """Thin bars and a thick one that cools last; SI.

    Attributes:
        young: E [Pa].
        expansion: α [1/K].
        rest: ΔT_p by which the thick bar is hotter when it is plastic for the last time [K].
        thin: area of all thin bars together [m²].
        thick: area of the thick one [m²].
    """

    young: float
    expansion: float
    rest: float
    thin: float
    thick: float


FRAMES = (Frame(70e9, 24e-6, 120.0, 2e-4, 4e-4), Frame(105e9, 11e-6, 85.0, 3e-4, 2.5e-4))


def frame(bars: Frame) -> FloatArray:
    """Return the stresses of the thick bar and of the thin bars [Pa].

    A_2 σ_2 + A_1 σ_1 = 0 and (σ_2 − σ_1)/E = α ΔT_p.
    """
    equations = np.array([[bars.thick, bars.thin], [1 / bars.young, -1 / bars.young]])
    return np.linalg.solve(equations, np.array([0.0, bars.expansion * bars.rest]))


def sphere(points: int) -> FloatArray:
    """Return normals of a sphere, evenly spread on a spiral and mirrored, (2 points, 3)."""
    height = (np.arange(points) + 0.5) / points
    angle = np.pi * (1 + np.sqrt(5)) * np.arange(points)
    flat = np.sqrt(1 - height**2)
    half = np.column_stack([flat * np.cos(angle), flat * np.sin(angle), height])
    return np.vstack([half, -half])


def turned(points: FloatArray) -> FloatArray:
    """Return points turned about two axes and moved."""
    a, b = 0.4, -1.1
    about_z = [[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]
    about_x = [[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]
    return np.asarray(points @ np.array(about_z).T @ np.array(about_x).T + [0.3, -0.1, 0.2])


def frame_answers() -> tuple[Answer, ...]:
    """Return the stresses of two frames."""
    made = []
    for bars in FRAMES:
        found = three_bar_stresses(bars.young, bars.expansion, bars.rest, bars.thin, bars.thick)
        made += [
            Answer.relative(f"{bar} of three, areas {1e4 * bars.thin:g} and {1e4 * bars.thick:g} "
                            "cm²", stress, exact, "Pa", 1e-12)
            for bar, stress, exact in zip(("thick bar", "thin bars"), found, frame(bars),
                                          strict=True)
        ]  # fmt: skip
    return tuple(made)


def sphere_answers() -> tuple[Answer, ...]:
    """Return the answers of a freely contracted sphere and of its corrected mould."""
    normals = sphere(400)
    nominal = RADIUS * normals
    places = turned((1 - CONTRACTION) * nominal)
    motion = best_fit(nominal, places, np.ones(len(nominal)))
    left = normal_deviation(nominal, motion.removed(places), normals)
    worst = left[np.argmax(np.abs(left + CONTRACTION * RADIUS))]
    made = [
        Answer.relative("deviation of a sphere, worst place", worst, -CONTRACTION * RADIUS, "m",
                        1e-10),
        Answer.relative("allowance",
                        allowance(nominal, motion.removed(places), normals,
                                  np.ones(len(nominal)))[0], CONTRACTION, "", 1e-10),
    ]  # fmt: skip
    mould = nominal
    for power in (2, 3):
        mould = compensated(mould, (1 - CONTRACTION) * mould, nominal)
        after = normal_deviation(nominal, (1 - CONTRACTION) * mould, normals)
        worst = after[np.argmax(np.abs(after + CONTRACTION**power * RADIUS))] / RADIUS
        name = f"left of the size after {power - 1} correction{'s' * (power > 2)} of the mould"
        made.append(Answer.relative(name, worst, -(CONTRACTION**power), "", 1e-9))
    return tuple(made)


def parabola() -> FloatArray:
    """Return points of a curved line, (points, 2) [m]."""
    x = np.linspace(-SPAN / 2, SPAN / 2, 41)
    return np.column_stack([x, CURVATURE / 2 * x**2])


def bore(lobes: int, angle: FloatArray) -> FloatArray:
    """Return the radii of a bore with lobes [m]."""
    return np.asarray(RADIUS + LOBE * np.cos(lobes * angle))


def form_answers() -> tuple[Answer, ...]:
    """Return flatness and roundness."""
    angle: FloatArray = np.arange(360) * np.pi / 180
    around = np.column_stack([np.cos(angle), np.sin(angle)])
    return (
        Answer.relative("flatness of a parabola", flatness(parabola()), CURVATURE * SPAN**2 / 8,
                        "m", 1e-10),
        *(
            Answer.relative(f"roundness of a bore with {lobes} lobes",
                            roundness(bore(lobes, angle)[:, None] * around + [0.2, -0.1]), 2 * LOBE,
                            "m", 1e-6)
            for lobes in (2, 3, 5)
        ),
    )  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Evaluate the functions beside their solutions."""
    answers = (*frame_answers(), *sphere_answers(), *form_answers())
    shares: FloatArray = np.linspace(0.05, 0.95, 19, dtype=np.float64)
    bars = [Frame(70e9, 24e-6, 120.0, 6e-4 * share, 6e-4 * (1 - share)) for share in shares]
    found = np.array(
        [three_bar_stresses(b.young, b.expansion, b.rest, b.thin, b.thick) for b in bars]
    )
    exact = np.array([frame(b) for b in bars])
    curves = tuple(
        Curve(name, shares, 1e-6 * found[:, k], shares, 1e-6 * exact[:, k])
        for k, name in enumerate(("thick bar", "thin bars"))
    )
    return Outcome(
        answers,
        max(answer.error for answer in answers),
        Comparison("area of the thin bars over all", "residual stress [MPa]", curves),
    )


VERIFICATION = Verification(
    number="F5",
    title="Stress and shape of a cold part: three bars, contraction, corrected moulds",
    formula="A_2 σ_2 + A_1 σ_1 = 0, (σ_2 − σ_1)/E = α ΔT_p; deviation −e R, −e² R and −e³ R after "
    "one and two corrections; flatness κ L²/8; roundness 2δ of R + δ cos mφ",
    source="equilibrium and compatibility; W. Kabsch, Acta Cryst. A 32 (1976) 922; geometry",
    run=compare,
    levels=MESHLESS,
    quick=MESHLESS,
    refined="nothing",
)
