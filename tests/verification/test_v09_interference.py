"""V9: shrink fit of a shaft in a hub (Lamé).

A solid shaft of radius a in a hub of outer radius b with radial overlap δ, plane stress, without
friction: p (C1 + C2) = δ with C1 = a (1 - ν1)/E1 and C2 = a/E2 ((b² + a²)/(b² - a²) + ν2); in the
hub σ_θ(r) = p a²/(b² - a²) (1 + b²/r²), in the shaft σ_r = σ_θ = -p. S. P. Timoshenko and J. N.
Goodier, Theory of Elasticity, 3rd ed., section 28.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.proof.verification.contact.shrink_fit import ShrinkFit
from tests.contact_methods import IN_THE_LIMIT
from tests.elastic_bodies import (
    at,
    body,
    centres,
    elastic,
    everywhere,
    gaps,
    generated,
    pressures,
    problem,
    stresses,
)

pytestmark = pytest.mark.sampled

FIT = ShrinkFit()
INNER, OUTER, OVERLAP, RATIO, PRESSURE = FIT.inner, FIT.outer, FIT.overlap, FIT.ratio, FIT.pressure
SHAFT, HUB = FIT.shaft, FIT.hub
SHAFT_COMPLIANCE, HUB_COMPLIANCE = FIT.shaft_compliance, FIT.hub_compliance


def fitted(comm, n: int, method: str = "condensed", rigid_shaft: bool = False, **numbers):
    """Return the problem with n elements on the radius of each body."""
    mesh = generated(
        comm, "plane-stress", "core_in_ring", ["core", "casting"],
        core_radius=INNER, outer_radius=OUTER, size=INNER / n,
    )  # fmt: skip
    bodies = {"casting": body(elastic(*HUB))}
    if not rigid_shaft:
        bodies["core"] = body(elastic(*SHAFT))
    overlap = Contact(
        "casting", "core", method, lambda points: np.full(len(points), -OVERLAP), settings=numbers
    )
    made = problem(mesh, bodies, {}, [overlap])
    made.equilibrium.solve(0.0)
    return made


def hoop_stresses(comm, made) -> tuple[np.ndarray, np.ndarray]:
    """Return radius and hoop stress in the cells of the hub."""
    middle, stress = centres(comm, made, "casting"), stresses(comm, made, "casting")
    radius = np.hypot(*middle.T)
    c, s = middle.T / radius
    return radius, stress[:, 0] * s**2 + stress[:, 1] * c**2 - 2 * stress[:, 3] * s * c


def errors(comm, n: int) -> tuple[float, float]:
    """Return the largest relative error of the pressure and the mean one of σ_θ."""
    made = fitted(comm, n)
    radius, hoop = hoop_stresses(comm, made)
    worst = np.abs(pressures(comm, made) / PRESSURE - 1).max()
    return float(worst), float(np.sqrt(np.mean((hoop / FIT.hoop_stress(radius) - 1) ** 2)))


@pytest.mark.parametrize("method", IN_THE_LIMIT)
def test_pressure_hoop_stress_and_displacement(comm, method):
    made = fitted(comm, 32, method)
    np.testing.assert_allclose(pressures(comm, made), PRESSURE, rtol=0.01)
    reported = everywhere(comm, made.contact_states()[0].pressure)
    np.testing.assert_allclose(reported, PRESSURE, rtol=0.01)
    assert np.abs(gaps(comm, made)).max() < 1e-12
    radius, hoop = hoop_stresses(comm, made)
    near = radius < INNER * (1 + 4 / 32)
    at_bore = np.polynomial.Polynomial.fit(radius[near], hoop[near], 2)(INNER)
    assert at_bore == pytest.approx(PRESSURE * RATIO, rel=0.01)
    for x, y in ((INNER, 0.0), (0.0, INNER)):
        assert np.hypot(*at(comm, made, "casting", x, y)[:2]) == pytest.approx(
            PRESSURE * HUB_COMPLIANCE, rel=0.01
        )
        assert np.hypot(*at(comm, made, "core", x, y)[:2]) == pytest.approx(
            PRESSURE * SHAFT_COMPLIANCE, rel=0.01
        )
    assert made.equilibrium.support_force() == 0.0


@pytest.mark.parametrize(
    "method, numbers", [("penalty", {}), ("block-iterative", {"block_iterations": 500})]
)
def test_a_penalty_is_a_third_compliance(comm, method, numbers):
    """Then p (C1 + C2 + 1/ε) = δ, with an ε that takes a quarter of the overlap."""
    softness = (SHAFT_COMPLIANCE + HUB_COMPLIANCE) / 3
    expected = OVERLAP / (SHAFT_COMPLIANCE + HUB_COMPLIANCE + softness)
    made = fitted(comm, 32, method, penalty=1 / softness, **numbers)
    np.testing.assert_allclose(pressures(comm, made), expected, rtol=0.01)
    np.testing.assert_allclose(gaps(comm, made), -expected * softness, rtol=0.01)


def test_a_rigid_shaft_leaves_all_to_the_hub(comm):
    made = fitted(comm, 32, "rigid", rigid_shaft=True)
    np.testing.assert_allclose(pressures(comm, made), OVERLAP / HUB_COMPLIANCE, rtol=0.01)
    assert np.abs(gaps(comm, made)).max() < 1e-12


@pytest.mark.serial  # a matter of the mesh; ranks agree in the other tests
def test_error_falls_with_the_element_size(comm):
    coarse, fine = errors(comm, 8), errors(comm, 16)
    assert coarse[0] > 1.6 * fine[0]
    assert coarse[1] > 1.6 * fine[1]
