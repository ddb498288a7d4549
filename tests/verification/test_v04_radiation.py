"""V4: two lumped bodies that exchange heat by radiation alone, through the gap between them.

Formula: C₁ dT₁/dt = −A φσ (T₁⁴ − T₂⁴) = −C₂ dT₂/dt, φ = 1/(1/ε₁ + 1/ε₂ − 1), absolute
temperatures. The references are the numbers of the case, and a Runge–Kutta solution of this
equation for other data. The bodies are blocks of a conductivity so high that they stay uniform.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests import coupled_cases

LENGTH = 0.01
TIMES = (10.0, 60.0, 300.0, 900.0, 3600.0)


@dataclass(frozen=True)
class Bodies:
    """Data of both bodies, the casting first."""

    area: float = 0.02
    emissivities: tuple[float, float] = (0.35, 0.85)
    capacities: tuple[float, float] = (900.0, 2400.0)
    temperatures: tuple[float, float] = (640.0, 220.0)

    def reference(self, times) -> np.ndarray:
        """Return both temperatures at times, shape (times, 2)."""
        (e1, e2), (C1, C2) = self.emissivities, self.capacities
        factor = 5.670374419e-8 * self.area / (1 / e1 + 1 / e2 - 1)

        def rates(_, T):
            heat = factor * ((T[0] + 273.15) ** 4 - (T[1] + 273.15) ** 4)
            return -heat / C1, heat / C2

        span = (0.0, max(times))
        return solve_ivp(rates, span, self.temperatures, t_eval=times, rtol=1e-10, atol=1e-9).y.T


GIVEN = Bodies()
COLDER = Bodies(0.07, (0.9, 0.2), (4000.0, 500.0), (180.0, 900.0))


def case(bodies: Bodies, steps: int) -> dict:
    """Return the case: per metre of depth the width of the strip is the area."""
    volume = bodies.area * LENGTH
    names = ("casting", "mould")
    return {
        "geometry": {"generator": "two_slabs", "model": "plane-strain", "length": LENGTH,
                     "mould_length": LENGTH, "width": bodies.area, "size": 0.02},
        "materials": {
            name: {"density": 1.0, "heat_capacity": capacity / volume, "conductivity": 1e5}
            for name, capacity in zip(names, bodies.capacities, strict=True)
        },
        "bodies": [
            {"name": name, "material": name, "temperature": T}
            for name, T in zip(names, bodies.temperatures, strict=True)
        ],
        "interfaces": [
            {"bodies": list(names), "contact": {"method": "none"},
             "heat": {"law": "none", "radiation": {"emissivities": list(bodies.emissivities)}}},
        ],
        "time": {"end": TIMES[-1], "fixed_step": TIMES[-1] / steps, "first_step": 1e-3,
                 "heat_substeps": 1},
        "coupling": {"scheme": "thermal"},
    }  # fmt: skip


def largest_error(comm, bodies: Bodies, steps: int, exact: np.ndarray) -> float:
    rows = []
    for state in coupled_cases.states(comm, case(bodies, steps)):
        fields = [coupled_cases.nodal(state, name, "temperature") for name in ("casting", "mould")]
        assert all(np.ptp(field) < 1e-2 for field in fields)
        rows.append((state.time, *(field.mean() for field in fields)))
    assert state.totals["energy_error"] < 1e-6
    given = bodies.capacities[0] * (bodies.temperatures[0] - rows[-1][1])
    assert state.totals["casting/mould.heat.radiation"] == pytest.approx(given, rel=1e-5)
    time, *temperatures = np.transpose(rows)
    found = np.transpose([np.interp(TIMES, time, T) for T in temperatures])
    return float(np.abs(found - exact).max())


def test_given_numbers(comm):
    exact = np.transpose([
        (637.3752, 624.7570, 573.8996, 490.8956, 367.0859),
        (220.9843, 225.7161, 244.7876, 275.9141, 322.3428),
    ])  # fmt: skip
    assert largest_error(comm, GIVEN, 500, exact) < 0.5
    assert np.abs(GIVEN.reference(TIMES) - exact).max() < 1e-4


@pytest.mark.serial
def test_error_falls_with_the_step(comm):
    exact = COLDER.reference(TIMES)
    errors = [largest_error(comm, COLDER, steps, exact) for steps in (500, 1000)]
    assert errors[1] < 2.0
    assert errors[0] / errors[1] > 1.6


@pytest.mark.serial
@pytest.mark.parametrize("change", [{"emissivities": (0.35, 0.5)}, {"emissivities": (0.25, 0.85)}])
def test_each_emissivity_acts(comm, change):
    bodies = replace(GIVEN, **change)
    assert largest_error(comm, bodies, 500, bodies.reference(TIMES)) < 0.5
    assert np.abs(bodies.reference(TIMES) - GIVEN.reference(TIMES)).max() > 5.0
