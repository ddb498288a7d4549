"""F3: hot tearing of an alloy, beside closed forms.

Suction in a columnar mush, f linear in T, integrals from T(1 − g_c) up, per ΔT_f and per ΔT_f²:
    H = 1/g_c + 2 ln g_c − g_c,   J = ∫_0^{1−g_c} ½ ((1−g_c)² − f²) f²/(1−f)³ df,
    Δp_sh = 180 μ v_T β ΔT_f H/(λ2² G),
    ε̇_c = (G/(J ΔT_f²)) [λ2² G Δp_c/(180 (1+β) μ) − v_T β ΔT_f H/(1+β)],
J a sum of powers and a logarithm of g = 1 − f. Scheil: T_m − T = (T_m − T_L)(1−f)^(k−1), so that
Kou's |dT/d√f| = 2 √f (1−k)(1−f)^(k−2)(T_m − T_L).
"""

from __future__ import annotations

from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.hot_tearing import clyne_davies_of_alloy, kou
from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import CriticalLiquid, Melt, dimensionless_niyama
from castx.foundry.suction import CUT_OFFS, MushSuction
from castx.materials.solid_fraction import LinearLaw, ScheilLaw
from castx.proof.verification.coupled.chilled_alloy import linear_suction
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


@dataclass(frozen=True)
class Columnar:
    """A columnar mush with f linear in T; SI.

    Attributes:
        solidus: T_S [°C].
        freezing_range: ΔT_f [K].
        gradient: G [K/m].
        speed: v_T [m/s].
        arm_spacing: λ2 [m].
        viscosity: μ [Pa s].
        contraction: β.
        depression: Δp_c [Pa].
    """

    solidus: float = 550.0
    freezing_range: float = 50.0
    gradient: float = 1e4
    speed: float = 1e-3
    arm_spacing: float = 50e-6
    viscosity: float = 1e-3
    contraction: float = 0.06
    depression: float = 2000.0

    @property
    def path(self) -> FreezingPath:
        """The way of freezing."""
        return FreezingPath(LinearLaw(), self.solidus, self.solidus + self.freezing_range)

    @property
    def melt(self) -> Melt:
        """Properties of the melt that decide how hard the mush is to feed."""
        return Melt(self.viscosity, self.contraction, self.depression)

    @property
    def place(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """G, v_T and λ2 as arrays of one place."""
        return np.array([self.gradient]), np.array([self.speed]), np.array([self.arm_spacing])

    def suction(self, cut_off: float) -> float:
        """Return Δp_sh [Pa]."""
        drag = self.viscosity * self.contraction * self.speed * self.freezing_range
        return float(drag * linear_suction(np.array(cut_off))) / (
            self.arm_spacing**2 * self.gradient
        )

    def critical_rate(self, cut_off: float) -> float:
        """Return ε̇_c [1/s], zero where shrinkage alone reaches Δp_c."""
        room = self.arm_spacing**2 * self.gradient / (180 * (1 + self.contraction) * self.viscosity)
        room *= max(self.depression - self.suction(cut_off), 0.0)
        return float(self.gradient * room / (straining(cut_off) * self.freezing_range**2))


def shrinking(cut_off: float) -> float:
    """Return H/ΔT_f for f linear in T."""
    return float(linear_suction(np.array(cut_off))) / 180


def straining(cut_off: float) -> float:
    """Return J for f linear in T."""
    g, whole = cut_off, (1 - cut_off) ** 2
    powers = (whole - 1) * (g**-2 - 1) / 2 + (4 - 2 * whole) * (1 / g - 1) + 4 * (1 - g)
    return float((powers - (whole - 6) * np.log(g) - (1 - g**2) / 2) / 2)


@dataclass(frozen=True)
class Scheil:
    """A binary alloy that freezes by Scheil down to its solidus.

    Attributes:
        partition: k.
        depression: T_m − T_L [K].
        solidus: [°C].
        melting: T_m [°C].
    """

    partition: float
    depression: float
    solidus: float = 400.0
    melting: float = 660.3

    @property
    def path(self) -> FreezingPath:
        """The way of freezing."""
        law = ScheilLaw(self.partition, self.melting)
        return FreezingPath(law, self.solidus, self.melting - self.depression)

    def slope(self, solid: float) -> float:
        """Return |dT/d√f| [K]."""
        falling = (1 - self.partition) * (1 - solid) ** (self.partition - 2)
        return float(2 * np.sqrt(solid) * falling * self.depression)

    @property
    def clyne_davies(self) -> float:
        """CSC by temperatures."""
        late, middle, early = (liquid ** (self.partition - 1) for liquid in (0.01, 0.1, 0.6))
        return float((late - middle) / (middle - early))


ALLOYS = (Scheil(0.13, 1.0), Scheil(0.17, 1.0))
BINARY = Scheil(0.17, 14.3)


def index_answers() -> tuple[Answer, ...]:
    """Return the indices of Clyne and Davies and of Kou."""
    ratio, index = "ratio of Clyne and Davies", "Kou's index"
    even = clyne_davies_of_alloy(FreezingPath(LinearLaw(), 560.0, 615.0))
    return (
        Answer.relative(f"{ratio}, f linear", even, 0.09 / 0.5, "", 1e-9),
        *(
            Answer.relative(f"{ratio}, Scheil, k = {alloy.partition:g}",
                            clyne_davies_of_alloy(alloy.path), alloy.clyne_davies, "", 1e-9)
            for alloy in ALLOYS
        ),
        Answer.relative(f"{index}, Scheil, f from 0.87 to 0.94", kou(BINARY.path),
                        BINARY.slope(0.94), "K", 1e-5),
        Answer.relative(f"{index}, Scheil, f from 0.6 to 0.87", kou(BINARY.path, (0.6, 0.87)),
                        BINARY.slope(0.87), "K", 1e-5),
    )  # fmt: skip


def mush_answers(mush: Columnar) -> tuple[Answer, ...]:
    """Return integrals, suctions and critical rates over the cut-off."""
    made = []
    gradient, speed, spacing = mush.place
    for cut in CUT_OFFS:
        found, where = MushSuction.of(mush.path, cut), f"g_c = {cut:g}"
        by_shrinkage = found.by_shrinkage(*mush.place, mush.melt)[0]
        rate = found.critical_rate(*mush.place, mush.melt)[0]
        width = mush.freezing_range
        made += [
            Answer.relative(f"integral of shrinkage, {where}", found.shrinking / width,
                            shrinking(cut), "", 1e-8),
            Answer.relative(f"integral of strain, {where}", found.straining / width**2,
                            straining(cut), "", 1e-8),
            Answer.relative(f"suction by shrinkage, {where}", by_shrinkage, mush.suction(cut),
                            "Pa", 1e-8),
            Answer.relative(f"critical rate of strain, {where}", rate, mush.critical_rate(cut),
                            "1/s", 1e-6),
        ]  # fmt: skip
    number = dimensionless_niyama(gradient, gradient * speed, spacing, mush.melt, width)[0]
    share = float(CriticalLiquid(mush.path).suction(np.array([0.02]))[0]) / number**2
    made.append(
        Answer.relative("I/Ny*² as share of Δp_c, g_c = 0.02", share,
                        mush.suction(0.02) / mush.depression, "", 1e-8)
    )  # fmt: skip
    still = Columnar(speed=0.0)
    rate = MushSuction.of(still.path, 0.02).critical_rate(*still.place, still.melt)[0]
    made.append(
        Answer.relative("critical rate of strain without shrinkage, g_c = 0.02", rate,
                        still.critical_rate(0.02), "1/s", 1e-8)
    )  # fmt: skip
    return tuple(made)


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Evaluate the functions beside their closed forms."""
    mush = Columnar()
    answers = (*mush_answers(mush), *index_answers())
    cuts: FloatArray = np.linspace(0.01, 0.06, 26, dtype=np.float64)
    line = fine(0.01, 0.06)
    rates = np.array(
        [MushSuction.of(mush.path, float(cut)).critical_rate(*mush.place, mush.melt)[0]
         for cut in cuts]
    )  # fmt: skip
    exact = np.array([mush.critical_rate(float(cut)) for cut in line])
    curve = Curve("f linear in T", cuts, rates, line, exact)
    return Outcome(
        answers,
        max(answer.error for answer in answers),
        Comparison("liquid fraction g_c at which dendrites have grown together",
                   "critical rate of strain [1/s]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="F3",
    title="Hot tearing of an alloy: suction, critical rate of strain, Clyne and Davies, Kou",
    formula="Δp_sh = 180 μ v_T β ΔT_f H/(λ2² G), ε̇_c = G λ2² G (Δp_c − Δp_sh)/(180 (1+β) μ J "
    "ΔT_f²), H = 1/g_c + 2 ln g_c − g_c, J = ∫ ½ ((1−g_c)² − f²) f²/(1−f)³ df; max |dT/d√f|; "
    "(T_0.9 − T_0.99)/(T_0.4 − T_0.9)",
    source="after M. Rappaz, J.-M. Drezet, M. Gremaud (1999), T. W. Clyne, G. J. Davies, and "
    "S. Kou (2015); integrals in closed form",
    run=compare,
    levels=MESHLESS,
    quick=MESHLESS,
    refined="nothing",
)
