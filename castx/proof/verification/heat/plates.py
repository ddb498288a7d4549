"""V5: steady heat through two plates with a given exchange between them.

Formula: q = (T_hot − T_cold) / (L/k + 1/h + L/k), exact with linear elements and nodal exchange.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.proof.verification.states import profile, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)


@dataclass(frozen=True)
class Plates:
    """Two plates of one kind; SI, °C.

    Attributes:
        thickness: of each [m].
        conductivity: [W/m/K].
        exchange: between them [W/m²/K].
        cold: outer face of one [°C].
        hot: outer face of the other [°C].
    """

    thickness: float = 0.495
    conductivity: float = 40.0
    exchange: float = 80.0
    cold: float = 100.0
    hot: float = 300.0

    @property
    def flux(self) -> float:
        """Q [W/m²]."""
        layers = 2 * self.thickness / self.conductivity + 1 / self.exchange
        return (self.hot - self.cold) / layers

    @property
    def walls(self) -> tuple[float, float]:
        """Temperatures of the faces that exchange heat, the hotter one first [°C]."""
        fall = self.flux * self.thickness / self.conductivity
        return self.hot - fall, self.cold + fall

    def case(self, size: float) -> dict[str, Any]:
        """Return the description of the case: three steps of many years, to the steady state."""
        ends = {"casting": self.hot, "mould": self.cold}
        steel = {"density": 1.0, "heat_capacity": 4e6, "conductivity": self.conductivity}
        return {
            "geometry": {"generator": "two_slabs", "model": "plane-strain", "width": size,
                         "length": self.thickness, "mould_length": self.thickness, "size": size},
            "materials": {"steel": steel},
            "bodies": [{"name": n, "material": "steel", "temperature": 20.0} for n in ends],
            "interfaces": [{"bodies": list(ends), "contact": {"method": "none"},
                            "heat": {"law": "constant", "closed": self.exchange}}],
            "boundaries": [
                {"on": f"{name}/far", "heat": {"type": "temperature", "value": end}}
                for name, end in ends.items()
            ],
            "time": {"end": 3e9, "fixed_step": 1e9, "first_step": 1e9, "largest_step": 1e9,
                     "heat_substeps": 1},
            "coupling": {"scheme": "thermal"},
            "solver": {"linear": "direct", "heat_tolerance": 1e-11},
        }  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Run to the steady state and compare."""
    plates, passed = Plates(), []
    for state in states(comm, plates.case(at.size)):
        passed.append((state.time, state.totals["casting/mould.heat"]))
    (before, last) = np.array(passed)[-2:]
    flux = (last[1] - before[1]) / (last[0] - before[0]) / at.size
    parts = [profile(state, body, "temperature") for body in ("mould", "casting")]
    x, T = (np.concatenate(column) for column in zip(*parts, strict=True))
    hot, cold = plates.walls
    L = plates.thickness
    line = np.array([-L, 0.0, 0.0, L])
    exact = np.array([plates.cold, cold, hot, plates.hot])
    return Outcome(
        (
            Answer.relative("flux", flux, plates.flux, "W/m²", 1e-6),
            Answer.relative("hotter face", parts[1][1][0], hot, "°C", 1e-6),
            Answer.relative("colder face", parts[0][1][-1], cold, "°C", 1e-6),
        ),
        abs(flux / plates.flux - 1),
        Comparison("distance from the interface [m]", "temperature [°C]",
                   (Curve("steady", x, T, line, exact),)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V5",
    title="Two plates with a given exchange",
    formula="q = (T_hot − T_cold)/(L/k + 1/h + L/k)",
    source="thermal resistances in series",
    run=compare,
    levels=(Resolution(0.055),),
    quick=(Resolution(0.055),),
    refined="nothing",
)
