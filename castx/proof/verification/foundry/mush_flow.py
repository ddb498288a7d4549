"""F4: flow of melt through a mush on one line, beside closed forms.

Column of length L, g = x/L, shut at x = 0 and fed at x = L, K = λ2² g³/(180 (1−g)²), below g_c that
of g_c. Freezing at ḟ and stretching at ε̇ draw w = −L [β ḟ g + ε̇ ((1+β) g − β g²/2)], and the
suction is ∫ μ w/K dx from the fed end. Behind a front whose flow ends where pores open
    180 μ v_T β ΔT_f/(λ2² G) [1/(2x) + 2 + (2 + x) ln x − 5x/2] = Δp_c at x = g_cr.
A mush loaded by q consolidates: by images p_l = q [1 − 2 Σ (−1)^n erfc((2n+1) L/(2√(c t)))] at the
base, where castx sums the series in time. Without drainage (1 + β f)(1 + u′) stays.
"""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
from scipy.optimize import brentq
from scipy.special import erfc

from castx.arrays import FloatArray
from castx.foundry.melt_levels import communicating
from castx.foundry.moving_front import PoresBehindFront
from castx.foundry.mush_column import MushResistance, column_suction
from castx.foundry.porosity import Melt
from castx.foundry.skeleton import consolidation, consolidation_coefficient, undrained
from castx.proof.verification.foundry.tearing import Columnar
from castx.proof.verification.verification import (
    MESHLESS,
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

MUSH = Columnar()
LENGTH = MUSH.freezing_range / MUSH.gradient
FREEZING = MUSH.speed / LENGTH
CUT = 0.02
ELEMENTS = 4000
RATE = 0.01
SHEAR, HEIGHT, LOAD, SOLID = 1e6, 10e-3, 1e4, 0.9
TIMES = (0.4374, 2.187, 4.374)
IMAGES = 40


def column(liquid: FloatArray, freezing: float, stretching: float) -> FloatArray:
    """Return the suction of the column at liquid fractions [Pa]."""
    beta, g = MUSH.contraction, np.maximum(liquid, CUT)
    drag = 180 * MUSH.viscosity * LENGTH**2 / MUSH.arm_spacing**2
    square = 1 / g + 2 * np.log(g) - g
    linear = -np.log(g) - 2 * (1 - g) + (1 - g**2) / 2
    above = freezing * beta * square + stretching * ((1 + beta) * square - beta / 2 * linear)

    def drawn(g: FloatArray) -> FloatArray:
        """Return ∫ of the flow over the length from the root."""
        by_strain = (1 + beta) * g**2 / 2 - beta * g**3 / 6
        return np.asarray(freezing * beta * g**2 / 2 + stretching * by_strain)

    floor = (1 - CUT) ** 2 / CUT**3
    below = floor * (drawn(np.array(CUT)) - drawn(np.minimum(liquid, CUT)))
    return np.asarray(drag * (above + below))


def found_column(freezing: float, stretching: float) -> tuple[FloatArray, FloatArray]:
    """Return liquid fractions of the nodes, and the suction there [Pa]."""
    x = np.unique(np.append(np.linspace(0.0, LENGTH, ELEMENTS + 1), CUT * LENGTH))
    frozen, stretched = (np.full(x.size, rate) for rate in (freezing, stretching))
    resistance = MushResistance(MUSH.melt, MUSH.arm_spacing, CUT)
    return x / LENGTH, column_suction(x, 1 - x / LENGTH, frozen, stretched, resistance)


def opening(depression: float) -> float:
    """Return g_cr behind a front, where the flow has ended."""
    drag = 180 * MUSH.viscosity * MUSH.speed * MUSH.contraction * MUSH.freezing_range
    drag /= MUSH.arm_spacing**2 * MUSH.gradient

    def over(x: float) -> float:
        whole = 1 / (2 * x) + 2 + (2 + x) * np.log(x) - 2.5 * x
        return float(drag * whole - depression)

    return float(brentq(over, 1e-6, 1 - 1e-6, xtol=1e-15, rtol=1e-14))


def coefficient() -> float:
    """Return c_v of the loaded mush [m²/s]."""
    permeability = MUSH.arm_spacing**2 * (1 - SOLID) ** 3 / (180 * SOLID**2)
    return permeability / MUSH.viscosity * 4 * SHEAR / 3


def images(time: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return settlement [m] and pressure at the base [Pa] of the loaded mush, by images."""
    n, depth = np.arange(IMAGES), 2 * np.sqrt(coefficient() * np.asarray(time))[:, None]
    sign = (-1.0) ** n
    base = LOAD * (1 - 2 * (erfc((2 * n + 1) * HEIGHT / depth) @ sign))
    # ∫ of the pressure over the height: each image by ∫ erfc.
    edges = np.arange(IMAGES + 1) * 2 * HEIGHT / depth
    whole = edges * erfc(edges) - np.exp(-(edges**2)) / np.sqrt(np.pi)
    lost = LOAD * depth[:, 0] * ((whole[:, 1:] - whole[:, :-1]) @ sign)
    return lost / (4 * SHEAR / 3), base


def column_answers() -> tuple[Answer, ...]:
    """Return the suction of the column by shrinkage, by strain and by both."""
    made: list[Answer] = []
    causes = {"shrinkage": (FREEZING, 0.0), "strain of 0.01/s": (0.0, RATE),
              "both": (FREEZING, RATE)}  # fmt: skip
    for cause, rates in causes.items():
        g, found = found_column(*rates)
        tolerance = 1e-8 if cause == "shrinkage" else 1e-7
        for where, at in (("g = 0.02", CUT), ("root", 0.0)):
            computed = found[int(np.argmin(np.abs(g - at)))]
            exact = float(column(np.array(at), *rates))
            name = f"suction of a column by {cause}, {where}"
            made.append(Answer.relative(name, computed, exact, "Pa", tolerance))
    at_cut = [float(column(np.array(CUT), *rates)) for rates in ((FREEZING, 0.0), (0.0, 1.0))]
    g, by_shrinkage = found_column(FREEZING, 0.0)
    by_strain = found_column(0.0, 1.0)[1]
    place = int(np.argmin(np.abs(g - CUT)))
    rate = (MUSH.depression - by_shrinkage[place]) / by_strain[place]
    exact = (MUSH.depression - at_cut[0]) / at_cut[1]
    made.append(Answer.relative("rate at which g = 0.02 reaches 2 kPa", rate, exact, "1/s", 1e-6))
    return tuple(made)


def pore_answers() -> tuple[Answer, ...]:
    """Return where pores open behind a front, and their share."""
    made: list[Answer] = []
    share = MUSH.contraction / (1 + MUSH.contraction)
    for depression in (100.0, 300.0):
        melt = Melt(MUSH.viscosity, MUSH.contraction, depression)
        front, exact = PoresBehindFront(MUSH.path, melt), opening(depression)
        where = f"{depression:g} Pa"
        made += [
            Answer.relative(f"liquid at which pores open behind a front, {where}",
                            front.critical_liquid(*MUSH.place)[0], exact, "", 1e-8),
            Answer.relative(f"pores behind a front, {where}", front.pores(*MUSH.place)[0],
                            share * exact, "", 1e-8),
        ]  # fmt: skip
    return tuple(made)


def found_consolidation(time: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return settlement [m] and pressure at the base [Pa] of the loaded mush."""
    permeability = MushResistance(MUSH.melt, MUSH.arm_spacing, CUT).permeability(
        np.array(1 - SOLID)
    )
    rate = consolidation_coefficient(float(permeability), MUSH.viscosity, SHEAR)
    return consolidation(time, HEIGHT, LOAD, SHEAR, rate)


def skeleton_answers() -> tuple[Answer, ...]:
    """Return the mush under a load, the one without drainage, and levels of feeders."""
    made: list[Answer] = []
    found, exact = found_consolidation(np.array(TIMES)), images(np.array(TIMES))
    for name, unit, k in (("settlement of a loaded mush", "m", 0), ("pressure at its base", "Pa",
                                                                    1)):  # fmt: skip
        made += [
            Answer.relative(f"{name}, {time:g} s", found[k][i], exact[k][i], unit, 1e-7)
            for i, time in enumerate(TIMES)
        ]
    strain, pressure = undrained(0.8, SOLID, MUSH.contraction, SHEAR)
    before, after = (1 + MUSH.contraction * f for f in (0.8, SOLID))
    level, given = communicating(np.array([4e-4, 1e-4]), np.array([0.05, 0.05]), 2e-6)
    uneven, _ = communicating(np.array([4e-4, 1e-4]), np.array([0.05, 0.04]), 2e-6)
    return (
        *made,
        Answer.relative("strain without drainage", strain, (before - after) / after, "", 1e-12),
        Answer.relative("pressure without drainage", pressure,
                        4 / 3 * SHEAR * (before - after) / after, "Pa", 1e-12),
        Answer.relative("fall of two feeders at one level", 0.05 - level, 2e-6 / 5e-4, "m", 1e-12),
        Answer.relative("volume that the larger one gives", given[0], 0.8 * 2e-6, "m³", 1e-12),
        Answer.relative("level of feeders at 50 and 40 mm", uneven, 0.044, "m", 1e-12),
    )  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Evaluate the functions beside their closed forms."""
    answers = (*column_answers(), *pore_answers(), *skeleton_answers())
    line, curves = fine(CUT, 0.5), []
    causes = (("shrinkage", FREEZING, 0.0), ("strain", 0.0, RATE), ("both", FREEZING, RATE))
    for name, freezing, stretching in causes:
        g, found = found_column(freezing, stretching)
        shown = (g >= CUT) & (g <= 0.5)
        exact = column(line, freezing, stretching)
        curves.append(Curve(name, g[shown], found[shown], line, exact))
    return Outcome(
        answers,
        max(answer.error for answer in answers),
        Comparison("liquid fraction", "suction of a column [Pa]", tuple(curves)),
    )


VERIFICATION = Verification(
    number="F4",
    title="Flow of melt through a mush: column, pores behind a front, load, feeders",
    formula="∫ μ w/K dx, w = −L (β ḟ g + ε̇ ((1+β) g − β g²/2)); "
    "1/(2x) + 2 + (2+x) ln x − 5x/2 ~ Δp_c; "
    "p_l = q (1 − 2 Σ (−1)^n erfc((2n+1) L/(2√(c t)))); (1 + β f)(1 + u′) stays; "
    "z = (Σ A z − V)/Σ A",
    source="Darcy's law with the permeability of Kozeny and Carman, integrated in closed form; "
    "K. Terzaghi (1943); images as in H. S. Carslaw and J. C. Jaeger, Conduction of Heat in Solids",
    run=compare,
    levels=MESHLESS,
    quick=MESHLESS,
    refined="nothing",
)
