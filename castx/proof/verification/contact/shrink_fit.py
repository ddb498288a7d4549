"""V9: shrink fit of a shaft in a hub, and the force to draw a core (Lamé).

A solid shaft of radius a in a hub of outer radius b with radial overlap δ, plane stress, without
friction: p (C1 + C2) = δ with C1 = a (1 - ν1)/E1 and C2 = a/E2 ((b² + a²)/(b² - a²) + ν2); in the
hub σ_θ(r) = p a²/(b² - a²) (1 + b²/r²), in the shaft σ_r = σ_θ = -p. S. P. Timoshenko and J. N.
Goodier, Theory of Elasticity, 3rd ed., section 28.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.proof.verification.states import cellwise, centres, paired, states
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
class ShrinkFit:
    """A shaft and a hub, SI.

    Attributes:
        inner: radius a of the shaft [m].
        outer: radius b of the hub [m].
        overlap: δ [m].
        shaft: E and ν.
        hub: E and ν.
    """

    inner: float = 0.03
    outer: float = 0.06
    overlap: float = 25e-6
    shaft: tuple[float, float] = (68e9, 0.33)
    hub: tuple[float, float] = (205e9, 0.29)

    @property
    def shaft_compliance(self) -> float:
        """C1 = a (1 - ν)/E, by which the surface of the shaft moves inwards [m/Pa]."""
        young, poisson = self.shaft
        return self.inner * (1 - poisson) / young

    @property
    def ratio(self) -> float:
        """(b² + a²)/(b² - a²), the hoop stress at the bore over the pressure."""
        return (self.outer**2 + self.inner**2) / (self.outer**2 - self.inner**2)

    @property
    def hub_compliance(self) -> float:
        """C2 = a/E ((b² + a²)/(b² - a²) + ν), by which the bore moves outwards [m/Pa]."""
        young, poisson = self.hub
        return self.inner / young * (self.ratio + poisson)

    @property
    def pressure(self) -> float:
        """The contact pressure p [Pa]."""
        return self.overlap / (self.shaft_compliance + self.hub_compliance)

    def hoop_stress(self, radius: FloatArray) -> FloatArray:
        """Return σ_θ in the hub [Pa]."""
        share = self.inner**2 / (self.outer**2 - self.inner**2)
        return np.asarray(self.pressure * share * (1 + self.outer**2 / radius**2))


def fitted_case(fit: ShrinkFit, size: float) -> dict[str, Any]:
    """Return the case; the overlap is an initial gap below zero."""
    names = {"core": fit.shaft, "casting": fit.hub}
    return {
        "geometry": {"generator": "core_in_ring", "model": "plane-stress", "size": size,
                     "core_radius": fit.inner, "outer_radius": fit.outer},
        "materials": {
            name: {"young_modulus": young, "poisson_ratio": poisson, "expansion": 0.0}
            for name, (young, poisson) in names.items()
        },
        "bodies": [{"name": name, "material": name, "temperature": 20.0} for name in names],
        "interfaces": [{"bodies": ["casting", "core"], "contact": {"initial_gap": -fit.overlap}}],
        "time": {"end": 1.0, "fixed_step": 1.0},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-9},
    }  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Press the shaft into the hub and compare."""
    fit = ShrinkFit()
    for state in states(comm, fitted_case(fit, at.size)):
        pressures = paired(state, "casting/core", "contact_pressure")
        gaps = paired(state, "casting/core", "gap")
        middle, stress = centres(state, "casting"), cellwise(state, "casting", "stress")
    radius = np.hypot(*middle.T)
    c, s = middle.T / radius
    hoop = stress[:, 0] * s**2 + stress[:, 1] * c**2 - 2 * stress[:, 3] * s * c
    near = radius < fit.inner + 4 * at.size
    at_bore = float(np.polyval(np.polyfit(radius[near], hoop[near], 2), fit.inner))
    worst = pressures[np.argmax(np.abs(pressures - fit.pressure))]
    order, line = np.argsort(radius), fine(fit.inner, fit.outer)
    curve = Curve("hub", radius[order], 1e-6 * hoop[order], line, 1e-6 * fit.hoop_stress(line))
    return Outcome(
        (
            Answer.relative("contact pressure, worst pair", worst, fit.pressure, "Pa", 0.01),
            Answer.relative("hoop stress at the bore", at_bore, fit.pressure * fit.ratio, "Pa",
                            0.01),
            Answer.difference("gap", np.abs(gaps).max(), "m", 1e-12),
        ),
        float(np.sqrt(np.mean((hoop / fit.hoop_stress(radius) - 1) ** 2))),
        Comparison("radius [m]", "hoop stress [MPa]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V9",
    title="Shrink fit of a shaft in a hub",
    formula="p (C1 + C2) = δ, C1 = a (1 − ν1)/E1, C2 = a/E2 ((b² + a²)/(b² − a²) + ν2); "
    "σ_θ(r) = p a²/(b² − a²) (1 + b²/r²)",
    source="G. Lamé; S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed., section 28",
    run=compare,
    levels=tuple(Resolution(0.03 / n) for n in (8, 16, 32)),
    quick=tuple(Resolution(0.03 / n) for n in (8, 16)),
    norm="root mean square of the relative error of the hoop stress",
)
