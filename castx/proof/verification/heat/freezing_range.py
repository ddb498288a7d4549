"""V3: an alloy with a freezing range solidifies at a chilled wall.

Source: similarity solution in η = x/√t as for Neumann's problem (J. A. Dantzig, M. Rappaz,
Solidification (2009), section 5); with properties that vary along the freezing range it is the
ordinary problem

    (k(T) T')' + η/2 C(T) T' = 0,   T(0) = wall,   T(∞) = start,   C = c(T) − L df_s/dT,

solved here by shooting for the flux at the wall.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mpi4py import MPI

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.proof.verification.heat.neumann import strip_case
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

FARTHEST = 60e-3
"""η at which the melt is still at its start temperature [m/√s]."""


@dataclass(frozen=True)
class FreezingRange:
    """A half-space of alloy whose solid fraction is linear; SI, °C, capacities per volume.

    Attributes:
        conductivity: of solid and liquid [W/m/K].
        capacity: of solid and liquid [J/m³/K].
        latent: heat [J/m³].
        solidus: [°C].
        liquidus: [°C].
        wall: temperature [°C].
        start: temperature of the liquid [°C].
    """

    conductivity: tuple[float, float] = (180.0, 85.0)
    capacity: tuple[float, float] = (2.75e6, 2.70e6)
    latent: float = 9.8e8
    solidus: float = 560.0
    liquidus: float = 615.0
    wall: float = 300.0
    start: float = 640.0

    def solid_fraction(self, T: float) -> float:
        """Return f_s."""
        return min(max((self.liquidus - T) / (self.liquidus - self.solidus), 0.0), 1.0)

    def _rates(self, eta: float, state: FloatArray, mushy: bool) -> list[float]:
        T, flux = state
        fraction = self.solid_fraction(T)
        (ks, kl), (cs, cl) = self.conductivity, self.capacity
        gradient = flux / (fraction * ks + (1 - fraction) * kl)
        capacity = fraction * cs + (1 - fraction) * cl
        capacity += mushy * self.latent / (self.liquidus - self.solidus)
        return [gradient, -eta / 2 * capacity * gradient]

    def _shoot(self, flux: float) -> list[Any]:
        """Return the solutions in the solid, the mushy zone and the liquid."""
        state, begin, parts = [self.wall, flux], 0.0, []
        for mushy, goal in ((False, self.solidus), (True, self.liquidus), (False, np.inf)):

            def reached(eta: float, state: FloatArray, mushy: bool, goal: float = goal) -> float:
                return float(state[0]) - goal if np.isfinite(goal) else -1.0

            vars(reached)["terminal"] = True
            part = solve_ivp(
                self._rates, (begin, FARTHEST), state, method="DOP853", rtol=1e-11, atol=1e-9,
                args=(mushy,), events=reached, dense_output=True,
            )  # fmt: skip
            parts.append(part)
            state, begin = part.y[:, -1], part.t[-1]
            if begin >= FARTHEST:
                break
        return parts

    @cached_property
    def flux(self) -> float:
        """The flux at the wall times √t [W √s/m²]."""

        def excess(q: float) -> float:
            return float(self._shoot(q)[-1].y[0, -1]) - self.start

        guess = self.conductivity[0] * (self.solidus - self.wall) / 7e-3
        return float(brentq(excess, 0.75 * guess, 1.35 * guess, rtol=1e-13))

    @cached_property
    def parts(self) -> list[Any]:
        """The solutions over η in the solid, the mushy zone and the liquid."""
        return self._shoot(self.flux)

    @property
    def fronts(self) -> tuple[float, float]:
        """Where solidus and liquidus are, over √t [m/√s]."""
        solid, mushy, *_ = self.parts
        return float(solid.t[-1]), float(mushy.t[-1])

    def temperature(self, x: FloatArray, time: float) -> FloatArray:
        """Return the temperature at distances x from the wall [°C]."""
        eta = np.minimum(np.asarray(x) / np.sqrt(time), FARTHEST)
        temperature: FloatArray = np.empty_like(eta)
        for part in reversed(self.parts):
            inside = eta <= part.t[-1]
            if inside.any():
                temperature[inside] = part.sol(eta[inside])[0]
        return temperature

    def gradient(self, eta: float) -> float:
        """Return dT/dη at a place [K √s/m]."""
        part = next(part for part in self.parts if eta <= part.t[-1])
        return self._rates(eta, part.sol(eta), False)[0]

    def place_of(self, fraction: float) -> float:
        """Return η where the solid fraction is one between zero and one [m/√s]."""
        level = self.liquidus - fraction * (self.liquidus - self.solidus)
        mushy = self.parts[1]
        return float(brentq(lambda eta: mushy.sol(eta)[0] - level, mushy.t[0], mushy.t[-1]))

    def niyama(self, fraction: float = 0.9) -> float:
        """Return G/√Ṫ, the same everywhere: √(2 T'/η) [K^½ s^½/m]."""
        eta = self.place_of(fraction)
        return float(np.sqrt(2 * self.gradient(eta) / eta))

    def material(self) -> dict[str, Any]:
        """Return the alloy of a case, of density 1000 kg/m³."""
        density = 1000.0
        solid, liquid = (value / density for value in self.capacity)
        return {
            "density": density,
            "heat_capacity": {"solid": solid, "liquid": liquid},
            "conductivity": dict(zip(("solid", "liquid"), self.conductivity, strict=True)),
            "latent_heat": self.latent / density,
            "solidus": self.solidus,
            "liquidus": self.liquidus,
        }


LENGTH, END = 0.12, 10.0


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Run to 10 s and compare."""
    exact = FreezingRange()
    case = strip_case(exact.material(), exact.start, exact.wall, at, length=LENGTH, end=END)
    passed = []
    for state in states(comm, case):
        passed.append(-state.totals["casting/wall.heat"] / at.size)
    x, found = profile(state, "casting", "temperature")
    error = found - exact.temperature(x, END)
    last = 2 * exact.flux * (np.sqrt(END) - np.sqrt(END - at.step)) / at.step
    solidus, liquidus = (front * np.sqrt(END) for front in exact.fronts)
    near, line = x < 0.06, fine(0.0, 0.06)
    curve = Curve("10 s", x[near], found[near], line, exact.temperature(line, END))
    return Outcome(
        (
            Answer.difference("temperature", np.abs(error).max(), "K", 1.5),
            Answer.relative("solidus", np.interp(exact.solidus, found, x), solidus, "m", 0.015),
            Answer.relative("liquidus", np.interp(exact.liquidus, found, x), liquidus, "m", 0.015),
            Answer.relative("flux at the wall", (passed[-1] - passed[-2]) / at.step, last, "W/m²",
                            0.01),
        ),
        float(np.abs(error).mean()),
        Comparison("distance from the wall [m]", "temperature [°C]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V3",
    title="Alloy with a freezing range on a chilled wall",
    formula="(k(T) T')' + η/2 C(T) T' = 0 over η = x/√t, C = c(T) − L df_s/dT, T(0) = wall, "
    "T(∞) = start",
    source="similarity in x/√t (J. A. Dantzig, M. Rappaz, Solidification (2009), section 5), "
    "solved by shooting",
    run=compare,
    levels=(Resolution(2e-3, 0.08), Resolution(1e-3, 0.04), Resolution(0.5e-3, 0.02)),
    quick=(Resolution(2e-3, 0.08), Resolution(1e-3, 0.04)),
    norm="mean error of the temperature [K]",
)
