"""V1: solidification of a pure metal at a chilled wall.

Source: F. Neumann's similarity solution, as in J. Crank, Free and Moving Boundary Problems (1984),
section 1.3. With X = 2λ√(α_s t) the front and r = √(α_s/α_l), λ solves

    k_s (Tm − Tw) e^(−λ²)/(√(πα_s) erf λ) − k_l (Ti − Tm) e^(−λ²r²)/(√(πα_l) erfc(λr)) = L λ √α_s.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mpi4py import MPI

import numpy as np
from scipy.optimize import brentq
from scipy.special import erf, erfc

from castx.arrays import FloatArray
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


@dataclass(frozen=True)
class Neumann:
    """A half-space of pure metal on a chilled wall; SI, °C, capacities and latent heat per volume.

    Attributes:
        conductivity: of solid and liquid [W/m/K].
        capacity: of solid and liquid [J/m³/K].
        latent: heat [J/m³].
        melting: point [°C].
        wall: temperature [°C].
        start: temperature of the liquid [°C].
    """

    conductivity: tuple[float, float] = (210.0, 95.0)
    capacity: tuple[float, float] = (3.0e6, 2.58e6)
    latent: float = 1.08048e9
    melting: float = 660.0
    wall: float = 580.0
    start: float = 740.0

    @property
    def diffusivity(self) -> tuple[float, float]:
        """Of solid and liquid [m²/s]."""
        return self.conductivity[0] / self.capacity[0], self.conductivity[1] / self.capacity[1]

    @property
    def ratio(self) -> float:
        """The number r = √(α_s/α_l)."""
        solid, liquid = self.diffusivity
        return float(np.sqrt(solid / liquid))

    def imbalance(self, x: float) -> float:
        """Return the heat that the front loses beyond its latent heat, zero for x = λ."""
        (ks, kl), (a, b), y = self.conductivity, self.diffusivity, x * self.ratio
        solid = ks * (self.melting - self.wall) * np.exp(-(x**2)) / (np.sqrt(np.pi * a) * erf(x))
        liquid = kl * (self.start - self.melting) * np.exp(-(y**2)) / (np.sqrt(np.pi * b) * erfc(y))
        return float(solid - liquid - self.latent * x * np.sqrt(a))

    @cached_property
    def front_number(self) -> float:
        """The number λ."""
        return float(brentq(self.imbalance, 1e-3, 3.0, xtol=1e-15))

    def front(self, time: float) -> float:
        """Return X [m]."""
        return float(2 * self.front_number * np.sqrt(self.diffusivity[0] * time))

    def wall_heat(self, time: float) -> float:
        """Return the heat through the wall per area [J/m²]."""
        fall = 2 * self.conductivity[0] * (self.melting - self.wall) * np.sqrt(time)
        return float(fall / (np.sqrt(np.pi * self.diffusivity[0]) * erf(self.front_number)))

    def temperature(self, x: FloatArray, time: float) -> FloatArray:
        """Return the temperature at distances x from the wall [°C]."""
        (a, b), n = self.diffusivity, self.front_number
        share = erf(x / (2 * np.sqrt(a * time))) / erf(n)
        solid = self.wall + (self.melting - self.wall) * share
        share = erfc(x / (2 * np.sqrt(b * time))) / erfc(n * self.ratio)
        liquid = self.start - (self.start - self.melting) * share
        return np.where(x < self.front(time), solid, liquid)

    def material(self) -> dict[str, Any]:
        """Return the metal of a case, of density 1."""
        return {
            "density": 1.0,
            "heat_capacity": dict(zip(("solid", "liquid"), self.capacity, strict=True)),
            "conductivity": dict(zip(("solid", "liquid"), self.conductivity, strict=True)),
            "latent_heat": self.latent,
            "solidus": self.melting,
            "liquidus": self.melting,
        }


def strip_case(
    material: dict[str, Any], start: float, wall: float, at: Resolution,
    *, length: float, end: float,
) -> dict[str, Any]:  # fmt: skip
    """Return a strip, one element wide, that a wall of constant temperature chills.

    Args:
        material: of the casting.
        start: its temperature [°C].
        wall: temperature of the wall [°C].
        at: size and step.
        length: of the strip [m].
        end: of the run [s].
    """
    return {
        "geometry": {
            "generator": "slab", "model": "plane-strain", "length": length, "width": at.size,
            "size": at.size,
        },
        "materials": {"metal": material},
        "bodies": [{"name": "casting", "material": "metal", "temperature": start}],
        "boundaries": [{"on": "casting/wall", "heat": {"type": "temperature", "value": wall}}],
        "time": {"end": end, "fixed_step": at.step, "first_step": at.step},
        "coupling": {"scheme": "thermal"},
    }  # fmt: skip


LENGTH, END = 0.12, 10.0


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Run to 10 s and compare."""
    exact = Neumann()
    case = strip_case(exact.material(), exact.start, exact.wall, at, length=LENGTH, end=END)
    *_, state = states(comm, case)
    x, found = profile(state, "casting", "temperature")
    error = found - exact.temperature(x, END)
    away = np.abs(x - exact.front(END)) > 2 * at.size
    heat = -state.totals["casting/wall.heat"] / at.size
    thickness = state.totals["casting.solid_fraction"] * LENGTH
    near, line = x < 0.06, fine(0.0, 0.06)
    curve = Curve("10 s", x[near], found[near], line, exact.temperature(line, END))
    return Outcome(
        (
            Answer.difference("temperature, 2 elements off the front", np.abs(error[away]).max(),
                              "K", 1.5),
            Answer.relative("front", thickness, exact.front(END), "m", 0.02),
            Answer.relative("heat through the wall", heat, exact.wall_heat(END), "J/m²", 0.01),
            Answer.difference("energy error", state.totals["energy_error"], "", 1e-6),
        ),
        float(abs(heat / exact.wall_heat(END) - 1)),
        Comparison("distance from the wall [m]", "temperature [°C]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V1",
    title="Pure metal on a chilled wall",
    formula="T = Tw + (Tm − Tw) erf(x/(2√(α_s t)))/erf λ in the solid, "
    "T = Ti − (Ti − Tm) erfc(x/(2√(α_l t)))/erfc(λr) in the liquid, front X = 2λ√(α_s t)",
    source="F. Neumann; J. Crank, Free and Moving Boundary Problems (1984), section 1.3",
    run=compare,
    levels=(Resolution(2e-3, 0.08), Resolution(1e-3, 0.04), Resolution(0.5e-3, 0.02)),
    quick=(Resolution(2e-3, 0.08), Resolution(1e-3, 0.04)),
    norm="relative error of the heat through the wall",
)
