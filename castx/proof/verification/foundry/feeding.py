"""F2: demand of an alloy on its feeders, beside closed forms.

The suction integral of Niyama's criterion is I(x) = ∫_x^1 180 (1-g)²/g² (dθ/dg) dg with
θ = (T - T_S)/ΔT_f: for f linear in T 180 (1/x + 2 ln x − x); by Scheil, T_m − T = (T_m − T_L)
g^(k−1), a sum of three powers. Pores open at I(g_cr) = Ny*². On a chilled wall Ny*, arm spacing and
pores follow from the similarity solution of V3. A plate in sand is solid when the half-space has
drawn its heat, 2 (T_m − T_0) √(k ρc t/π) per area.
"""

from __future__ import annotations

from collections.abc import Callable

from mpi4py import MPI

import numpy as np
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.foundry.arm_spacing import ArmSpacing
from castx.foundry.modulus import PouredMetal, SandMould, mould_constant, thermal_modulus
from castx.foundry.mush import FreezingPath
from castx.foundry.porosity import CriticalLiquid, Melt, dimensionless_niyama, pore_fraction
from castx.materials.solid_fraction import LinearLaw, ScheilLaw
from castx.proof.verification.coupled.chilled_alloy import (
    AT,
    ChilledAlloy,
    critical_liquid,
    linear_suction,
)
from castx.proof.verification.verification import (
    MESHLESS,
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

LIQUIDS = (0.9, 0.5, 0.2, 0.1, 0.05, 0.02)
PARTITION, MELTING, LIQUIDUS, EUTECTIC = 0.14, 660.3, 646.0, 548.2
EUTECTIC_LIQUID = float(((MELTING - EUTECTIC) / (MELTING - LIQUIDUS)) ** (1 / (PARTITION - 1)))
SCHEIL_LIQUIDS = (0.5, 0.3, 0.2, EUTECTIC_LIQUID)
PLACES = (5e-3, 10e-3, 20e-3)
METAL = PouredMetal(9.8e8, 2.7e6, 640.0, 560.0, 615.0)
SAND = SandMould(0.7, 1.6e6, 20.0)
MODULI = (5e-3, 10e-3, 20e-3)


def scheil_suction(liquid: FloatArray) -> FloatArray:
    """Return I(x) of the alloy that freezes by Scheil."""
    k = PARTITION
    powers = {k - 3: 1.0, k - 2: -2.0, k - 1: 1.0}
    total = sum(share * (1 - liquid**n) / n for n, share in powers.items())
    slope = (1 - k) * (MELTING - LIQUIDUS) / (LIQUIDUS - EUTECTIC)
    return np.asarray(180 * slope * total)


def solidification_time(modulus: float) -> float:
    """Return when a half-space of sand has drawn the heat of a modulus of metal [s]."""
    heat = METAL.latent_heat + METAL.heat_capacity * (METAL.pouring - METAL.liquidus)
    rise = (METAL.solidus + METAL.liquidus) / 2 - SAND.temperature
    effusivity = np.sqrt(SAND.conductivity * SAND.heat_capacity)

    def left(time: float) -> float:
        return float(2 * rise * effusivity * np.sqrt(time / np.pi) - heat * modulus)

    return float(brentq(left, 0.0, 1e8, xtol=1e-9, rtol=1e-14))


def suction_answers() -> tuple[Answer, ...]:
    """Return I and its inverse for f linear in T and by Scheil."""
    made: list[Answer] = []
    laws: tuple[tuple[str, FreezingPath, tuple[float, ...], Callable[..., FloatArray]], ...] = (
        ("f linear", FreezingPath(LinearLaw(), 560.0, 615.0), LIQUIDS, linear_suction),
        ("Scheil", FreezingPath(ScheilLaw(PARTITION, MELTING), EUTECTIC, LIQUIDUS),
         SCHEIL_LIQUIDS, scheil_suction),
    )  # fmt: skip
    for law, path, liquids, suction in laws:
        critical, at = CriticalLiquid(path), np.array(liquids)
        names = [f"{law}, g = {g:.6g}" for g in liquids]
        exact = np.sqrt(suction(at))
        found = np.sqrt(critical.suction(at))
        made += Answer.rows("Ny* where pores open", _named(names, found), _named(names, exact), "",
                            1e-7)  # fmt: skip
        # Just below the eutectic all that is left freezes at once: there is no inverse.
        inside = at > EUTECTIC_LIQUID if law == "Scheil" else np.full(at.shape, True)
        kept = [name for name, keep in zip(names, inside, strict=True) if keep]
        made += Answer.rows("critical liquid of this Ny*", _named(kept, critical(exact[inside])),
                            _named(kept, at[inside]), "", 1e-7)  # fmt: skip
    return tuple(made)


def wall_answers(alloy: ChilledAlloy) -> tuple[Answer, ...]:
    """Return arm spacing, Ny* and pores on a chilled wall from its gradient and cooling rate."""
    at = np.array(PLACES)
    rate = alloy.cooling_rate(at)
    gradient = alloy.half_space.niyama(AT) * np.sqrt(rate)
    interval = alloy.half_space.liquidus - alloy.half_space.solidus
    melt = Melt(alloy.viscosity, alloy.contraction, alloy.depression)
    spacing = ArmSpacing(alloy.arms)(rate)
    number = dimensionless_niyama(gradient, rate, spacing, melt, interval)
    path = FreezingPath(LinearLaw(), alloy.half_space.solidus, alloy.half_space.liquidus)
    pores = pore_fraction(CriticalLiquid(path)(number), alloy.shrinkage)
    names = [f"{1e3 * x:g} mm from a chilled wall" for x in PLACES]
    return (
        *Answer.rows("arm spacing", _named(names, spacing), _named(names, alloy.arm_spacing(at)),
                     "m", 1e-10),
        *Answer.rows("Ny*", _named(names, number),
                     _named(names, alloy.dimensionless_niyama(at)), "", 1e-10),
        *Answer.rows("pore fraction", _named(names, pores), _named(names, alloy.pore_fraction(at)),
                     "", 1e-7),
    )  # fmt: skip


def modulus_answers() -> tuple[Answer, ...]:
    """Return times of solidification by Chvorinov's constant, and moduli of these times."""
    names = [f"V/A = {1e3 * modulus:g} mm" for modulus in MODULI]
    times = np.array([solidification_time(modulus) for modulus in MODULI])
    constant = mould_constant(METAL, SAND)
    return (
        Answer.relative("Chvorinov's constant", constant, times[1] / MODULI[1] ** 2, "s/m²", 1e-10),
        *Answer.rows("time of solidification in sand",
                     _named(names, constant * np.array(MODULI) ** 2), _named(names, times), "s",
                     1e-10),
        *Answer.rows("modulus from this time", _named(names, thermal_modulus(times, constant)),
                     _named(names, np.array(MODULI)), "m", 1e-10),
    )  # fmt: skip


def _named(names: list[str], values: FloatArray) -> dict[str, float]:
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Evaluate the functions beside their closed forms."""
    answers = (*suction_answers(), *wall_answers(ChilledAlloy()), *modulus_answers())
    numbers: FloatArray = np.linspace(2.0, 80.0, 27, dtype=np.float64)
    path = FreezingPath(LinearLaw(), 560.0, 615.0)
    exact = np.array([critical_liquid(float(number)) for number in numbers])
    curve = Curve("f linear in T", numbers, CriticalLiquid(path)(numbers), numbers, exact)
    return Outcome(
        answers,
        max(answer.error for answer in answers),
        Comparison("dimensionless Niyama value Ny*", "liquid fraction at which pores open",
                   (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="F2",
    title="Feeding of an alloy: suction, Niyama values, pores, Chvorinov's constant",
    formula="I(g_cr) = Ny*²; I = 180 (1/x + 2 ln x − x) for f linear in T, by Scheil "
    "180 (1−k) (T_m−T_L)/ΔT_f ∫_x^1 (1−g)² g^(k−4) dg; 2 (T_m−T_0) √(kρc t_s/π) = "
    "(ρL + ρc ΔT) V/A",
    source="K. D. Carlson, C. Beckermann, Metall. Mater. Trans. A 40 (2009) 163; N. Chvorinov, "
    "Die Giesserei 27 (1940) 177; the similarity solution of V3",
    run=compare,
    levels=MESHLESS,
    quick=MESHLESS,
    refined="nothing",
)
