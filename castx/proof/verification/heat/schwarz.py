"""V2: a melt on a mould in perfect contact, both half-spaces.

Source: C. Schwarz, Arch. Eisenhüttenwes. 5 (1931) 139; J. A. Dantzig, M. Rappaz, Solidification
(2009), section 5. The interface has one temperature T_i at all times; with X = 2λ√(α_s t) the front
and r = √(α_s/α_l),

    k_m (T_i − T_0)/√α_m = k_s (Tm − T_i)/(√α_s erf λ)        heat through the interface
    k_s (Tm − T_i) e^(−λ²)/(√(πα_s) erf λ) − k_l (Ti − Tm) e^(−λ²r²)/(√(πα_l) erfc(λr))
        = L λ √α_s                                            heat at the front.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from mpi4py import MPI

import numpy as np
from scipy.optimize import brentq
from scipy.special import erf, erfc

from castx.arrays import FloatArray
from castx.proof.verification.heat.neumann import Neumann
from castx.proof.verification.states import profile, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

METAL = Neumann((225.0, 92.0), (2.95e6, 2.58e6), 9.45e8, 660.0, np.nan, 670.0)
"""The casting; the temperature of its wall follows from the mould."""


@dataclass(frozen=True)
class Schwarz:
    """A casting and a mould; SI, °C, capacities per volume.

    Attributes:
        metal: the casting, whose wall is the interface.
        conductivity: of the mould [W/m/K].
        capacity: of the mould [J/m³/K].
        cold: temperature of the mould at the start [°C].
    """

    metal: Neumann = METAL
    conductivity: float = 38.0
    capacity: float = 4.1e6
    cold: float = 200.0

    @property
    def diffusivity(self) -> float:
        """Of the mould [m²/s]."""
        return self.conductivity / self.capacity

    def interface_for(self, x: float) -> float:
        """Return the temperature of the interface for a λ [°C]."""
        mould = self.conductivity / np.sqrt(self.diffusivity)
        solid = self.metal.conductivity[0] / (np.sqrt(self.metal.diffusivity[0]) * erf(x))
        return float((mould * self.cold + solid * self.metal.melting) / (mould + solid))

    @cached_property
    def casting(self) -> Neumann:
        """The casting, with the temperature of its wall."""

        def imbalance(x: float) -> float:
            return replace(self.metal, wall=self.interface_for(x)).imbalance(x)

        number = float(brentq(imbalance, 1e-3, 3.0, xtol=1e-15))
        return replace(self.metal, wall=self.interface_for(number))

    @property
    def interface(self) -> float:
        """Temperature of the interface [°C]."""
        return self.casting.wall

    def mould_heat(self, time: float) -> float:
        """Return the heat that the mould has received per area [J/m²]."""
        rise = 2 * self.conductivity * (self.interface - self.cold)
        return float(rise * np.sqrt(time / (np.pi * self.diffusivity)))

    def temperature(self, x: FloatArray, time: float) -> FloatArray:
        """Return the temperature [°C]; the mould is at x < 0."""
        share = erfc(-x / (2 * np.sqrt(self.diffusivity * time)))
        mould = self.cold + (self.interface - self.cold) * share
        return np.where(x < 0, mould, self.casting.temperature(x, time))


LENGTH, DEPTH, END = 0.12, 0.06, 10.0


def two_strips(
    casting: dict[str, Any], mould: dict[str, Any], heat: dict[str, Any], at: Resolution,
    *, lengths: tuple[float, float], temperatures: tuple[float, float], end: float,
) -> dict[str, Any]:  # fmt: skip
    """Return a strip of casting on one of mould, one element wide.

    Args:
        casting: material at x > 0.
        mould: material at x < 0.
        heat: what an interface says of its heat.
        at: size and step.
        lengths: of casting and mould [m].
        temperatures: at the start [°C].
        end: of the run [s].
    """
    names = ("casting", "mould")
    return {
        "geometry": {
            "generator": "two_slabs", "model": "plane-strain", "length": lengths[0],
            "mould_length": lengths[1], "width": at.size, "size": at.size,
        },
        "materials": dict(zip(names, (casting, mould), strict=True)),
        "bodies": [
            {"name": name, "material": name, "temperature": start}
            for name, start in zip(names, temperatures, strict=True)
        ],
        "interfaces": [{"bodies": list(names), "contact": {"method": "none"}, "heat": heat}],
        "time": {"end": end, "fixed_step": at.step, "first_step": at.step},
        "coupling": {"scheme": "thermal"},
    }  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Run to 10 s and compare."""
    exact = Schwarz()
    steel = {"density": 1.0, "heat_capacity": exact.capacity, "conductivity": exact.conductivity}
    case = two_strips(
        exact.metal.material(), steel, {"law": "perfect"}, at, lengths=(LENGTH, DEPTH),
        temperatures=(exact.metal.start, exact.cold), end=END,
    )  # fmt: skip
    *_, state = states(comm, case)
    parts = [profile(state, body, "temperature") for body in ("mould", "casting")]
    x, found = (np.concatenate(column) for column in zip(*parts, strict=True))
    error = found - exact.temperature(x, END)
    away = np.abs(x - exact.casting.front(END)) > 2 * at.size
    thickness = state.totals["casting.solid_fraction"] * LENGTH
    heat = state.totals["mould.heat_in"]
    shown, line = (x > -0.04) & (x < 0.04), fine(-0.04, 0.04)
    curve = Curve("10 s", x[shown], found[shown], line, exact.temperature(line, END))
    return Outcome(
        (
            Answer.difference("temperature, 2 elements off the front", np.abs(error[away]).max(),
                              "K", 1.5),
            Answer.relative("front", thickness, exact.casting.front(END), "m", 0.02),
            Answer.relative("heat in the mould", heat / at.size, exact.mould_heat(END), "J/m²",
                            0.01),
            Answer.relative("heat out of the casting", state.totals["casting/mould.heat"], heat,
                            "J/m", 1e-10),
        ),
        float(np.abs(error).mean()),
        Comparison("distance from the interface [m]", "temperature [°C]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V2",
    title="Casting on a mould, perfect contact",
    formula="k_m (T_i − T_0)/√α_m = k_s (Tm − T_i)/(√α_s erf λ) at the interface, Neumann's "
    "balance at the front X = 2λ√(α_s t)",
    source="C. Schwarz, Arch. Eisenhüttenwes. 5 (1931) 139; J. A. Dantzig, M. Rappaz, "
    "Solidification (2009), section 5",
    run=compare,
    levels=(Resolution(2e-3, 0.16), Resolution(1e-3, 0.08), Resolution(0.5e-3, 0.04)),
    quick=(Resolution(2e-3, 0.16), Resolution(1e-3, 0.08)),
    norm="mean error of the temperature [K]",
)
