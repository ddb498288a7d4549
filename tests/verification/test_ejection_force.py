"""The force to draw a core out of a ring that has shrunk onto it (Lamé, times friction).

A ring of inner radius a and outer radius b cools by ΔT on a solid core of constant temperature,
plane stress: p (C1 + C2) = α ΔT a with C1 = a (1 - ν1)/E1 of the core and
C2 = a/E2 ((b² + a²)/(b² - a²) + ν2) of the ring (S. P. Timoshenko and J. N. Goodier, Theory of
Elasticity, 3rd ed., section 28). A quarter of the circumference presses with p π a/2 per metre of
depth, of which friction makes the force. Once the core is out, the ring is free of stress.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.coupled_cases import final_state, places, states

INNER, OUTER, COOLING, FRICTION = 0.03, 0.05, 120.0, 0.35
CORE = {"young_modulus": 190e9, "poisson_ratio": 0.28, "expansion": 1.1e-5}
RING = {"young_modulus": 60e9, "poisson_ratio": 0.34, "expansion": 2.2e-5}
RATIO = (OUTER**2 + INNER**2) / (OUTER**2 - INNER**2)
SHRINKAGE = RING["expansion"] * COOLING * INNER
PRESSURE = SHRINKAGE / (
    INNER * (1 - CORE["poisson_ratio"]) / CORE["young_modulus"]
    + INNER / RING["young_modulus"] * (RATIO + RING["poisson_ratio"])
)
NORMAL = PRESSURE * np.pi * INNER / 2


def case(n: int, method: str = "condensed") -> dict:
    """Return the case with n elements on the radius of the core; the core is drawn at 3 s."""
    return {
        "geometry": {
            "generator": "core_in_ring", "model": "plane-stress", "core_radius": INNER,
            "outer_radius": OUTER, "size": INNER / n,
        },
        "materials": {"a": {**CORE, "stress_free": 20.0}, "b": {**RING, "stress_free": 20.0}},
        "bodies": [
            {"name": "core", "material": "a", "temperature": 20.0},
            {"name": "casting", "material": "b",
             "temperature_history": [[0.0, 20.0], [2.0, 20.0 - COOLING]]},
        ],
        "interfaces": [{"bodies": ["casting", "core"], "contact": {"method": method}}],
        "time": {"end": 4.0, "fixed_step": 1.0},
        "stages": [{"at": "3 s", "remove": ["core"], "eject": {"core": FRICTION}}],
        "coupling": {"scheme": "mechanical"},
        "solver": {"mechanics_tolerance": 1e-9},
    }  # fmt: skip


@pytest.mark.parametrize(
    "method", ["condensed", pytest.param("multipliers", marks=pytest.mark.serial)]
)
def test_force_is_friction_times_the_normal_force(comm, method):
    forces = []
    for state in states(comm, case(24, method)):
        forces.append(state.totals["core.ejection_force"])
    assert forces[3] == pytest.approx(FRICTION * NORMAL, rel=2e-3)
    found = state.process.events[-1]["ejection"]["core"]
    assert found["friction"] == FRICTION
    assert found["normal"] == pytest.approx(NORMAL, rel=2e-3)
    assert found["force"] == forces[3]
    assert forces[0] == forces[4] == 0.0


@pytest.mark.serial
def test_the_estimate_converges(comm):
    errors = []
    for n in (6, 12, 24):
        *_, last = states(comm, case(n))
        force = last.process.events[-1]["ejection"]["core"]["force"]
        errors.append(abs(force / (FRICTION * NORMAL) - 1))
    assert errors[-1] < 2e-3
    assert min(np.log2(errors[0] / errors[1]), np.log2(errors[1] / errors[2])) > 1.7


@pytest.mark.ranks
def test_the_ring_springs_back(comm):
    """Without the core nothing is left but the thermal contraction."""
    after = final_state(comm, case(6))
    assert after.cellwise("casting", "von_mises").max(initial=0.0) < 1e-7 * PRESSURE
    x = places(after, "casting")
    u = after.nodal("casting", "displacement")[: len(x)]
    np.testing.assert_allclose(u, -RING["expansion"] * COOLING * x, atol=1e-10 * INNER)
    assert after.totals["casting/core.force.x"] == after.totals["casting/core.force.y"] == 0.0
