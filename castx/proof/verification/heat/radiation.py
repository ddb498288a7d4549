"""V4: two lumped bodies that exchange heat by radiation alone, through the gap between them.

Formula: C₁ dT₁/dt = −A φσ (T₁⁴ − T₂⁴) = −C₂ dT₂/dt, φ = 1/(1/ε₁ + 1/ε₂ − 1), absolute
temperatures, integrated here by a Runge–Kutta method. The bodies are blocks of a conductivity so
high that they stay uniform.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mpi4py import MPI

import numpy as np
from scipy.integrate import solve_ivp

from castx.arrays import FloatArray
from castx.proof.verification.states import nodal, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

LENGTH = 0.01
TIMES = (10.0, 60.0, 300.0, 900.0, 3600.0)
NAMES = ("casting", "mould")


@dataclass(frozen=True)
class Lumps:
    """Data of both bodies, the casting first; SI, °C.

    Attributes:
        area: that radiates [m²].
        emissivities: of both faces.
        capacities: [J/K].
        temperatures: at the start [°C].
    """

    area: float = 0.02
    emissivities: tuple[float, float] = (0.35, 0.85)
    capacities: tuple[float, float] = (900.0, 2400.0)
    temperatures: tuple[float, float] = (640.0, 220.0)

    def reference(self, times: Any) -> FloatArray:
        """Return both temperatures at times, shape (times, 2)."""
        (e1, e2), (C1, C2) = self.emissivities, self.capacities
        factor = 5.670374419e-8 * self.area / (1 / e1 + 1 / e2 - 1)

        def rates(_: float, T: FloatArray) -> tuple[float, float]:
            heat = factor * ((T[0] + 273.15) ** 4 - (T[1] + 273.15) ** 4)
            return -heat / C1, heat / C2

        solved = solve_ivp(
            rates, (0.0, max(times)), self.temperatures, t_eval=times, rtol=1e-10, atol=1e-9
        )
        return np.asarray(solved.y.T)

    def case(self, steps: int) -> dict[str, Any]:
        """Return the case: per metre of depth the width of the strip is the area."""
        volume = self.area * LENGTH
        return {
            "geometry": {"generator": "two_slabs", "model": "plane-strain", "length": LENGTH,
                         "mould_length": LENGTH, "width": self.area, "size": 0.02},
            "materials": {
                name: {"density": 1.0, "heat_capacity": capacity / volume, "conductivity": 1e5}
                for name, capacity in zip(NAMES, self.capacities, strict=True)
            },
            "bodies": [
                {"name": name, "material": name, "temperature": T}
                for name, T in zip(NAMES, self.temperatures, strict=True)
            ],
            "interfaces": [
                {"bodies": list(NAMES), "contact": {"method": "none"},
                 "heat": {"law": "none", "radiation": {"emissivities": list(self.emissivities)}}},
            ],
            "time": {"end": TIMES[-1], "fixed_step": TIMES[-1] / steps, "first_step": 1e-3,
                     "heat_substeps": 1},
            "coupling": {"scheme": "thermal"},
        }  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Let the bodies radiate for an hour; the step is a share of it."""
    lumps, rows = Lumps(), []
    for state in states(comm, lumps.case(round(1 / at.step))):
        rows.append((state.time, *(nodal(state, name, "temperature").mean() for name in NAMES)))
    time, *found = np.array(rows).T
    exact = lumps.reference(TIMES)
    errors = [np.abs(np.interp(TIMES, time, T) - e) for T, e in zip(found, exact.T, strict=True)]
    line = fine(0.0, TIMES[-1])
    solved = lumps.reference(line).T
    curves = tuple(
        Curve(name, time, T, line, solved[k])
        for k, (name, T) in enumerate(zip(NAMES, found, strict=True))
    )
    return Outcome(
        (
            Answer.difference("temperature of the casting", errors[0].max(), "K", 0.5),
            Answer.difference("temperature of the mould", errors[1].max(), "K", 0.5),
            Answer.difference("energy error", state.totals["energy_error"], "", 1e-6),
        ),
        float(max(error.max() for error in errors)),
        Comparison("time [s]", "temperature [°C]", curves),
    )


VERIFICATION = Verification(
    number="V4",
    title="Radiation between two lumped bodies",
    formula="C₁ dT₁/dt = −A φσ (T₁⁴ − T₂⁴) = −C₂ dT₂/dt, φ = 1/(1/ε₁ + 1/ε₂ − 1)",
    source="the law of Stefan and Boltzmann between parallel grey faces, integrated",
    run=compare,
    levels=tuple(Resolution(0.02, 1 / steps) for steps in (125, 250, 500)),
    quick=tuple(Resolution(0.02, 1 / steps) for steps in (125, 250)),
    refined="step",
    norm="largest error of a temperature [K]",
)
