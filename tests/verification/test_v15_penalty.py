"""V15: penalty and augmented Lagrangian in closed form.

Two bars, ν = 0, squeezed by d between their far ends. The pressure is p = d/(L1/E1 + L2/E2 + 1/ε)
with a penetration of p/ε; every augmentation multiplies the penetration by
ρ = (1/ε)/(L1/E1 + L2/E2 + 1/ε). Without penetration p = d/(L1/E1 + L2/E2).
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.proof.verification.contact.squeezed_bars import (
    COMPLIANCE,
    LENGTH,
    SQUEEZE,
    YOUNG,
    pressure,
)
from tests.elastic_bodies import blocks, body, elastic, fixed, gaps, pressures, problem

pytestmark = pytest.mark.sampled


def bars(comm, method: str, model: str = "plane-strain", **settings):
    """Return the solved bars and the report."""
    mesh = blocks(comm, model, (0.02, LENGTH), (0.02, LENGTH), size=0.01)
    bodies = {name: body(elastic(E, 0.0)) for name, E in YOUNG.items()}
    held = {"base": [fixed("bottom")], "upper": [fixed("top", value=-SQUEEZE)]}
    made = problem(mesh, bodies, held, [Contact("upper", "base", method, settings=settings)])
    return made, made.equilibrium.solve(0.0)


@pytest.mark.parametrize("penalty", [1e10, 1e12, 1e14])
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_penalty(comm, model, penalty):
    made, _ = bars(comm, "penalty", model, penalty=penalty)
    expected = pressure(penalty)
    np.testing.assert_allclose(pressures(comm, made), expected, rtol=1e-8)
    np.testing.assert_allclose(gaps(comm, made), -expected / penalty, rtol=1e-8)


@pytest.mark.ranks
@pytest.mark.parametrize("augmentation", ["iteration", "loop"])
@pytest.mark.parametrize("updates", [0, 1, 4])
def test_each_augmentation_shrinks_the_penetration(comm, augmentation, updates):
    penalty = 1e12
    made, report = bars(
        comm, "augmented-lagrangian", penalty=penalty, augmentation=augmentation,
        augmentations=updates,
    )  # fmt: skip
    ratio = (1 / penalty) / (COMPLIANCE + 1 / penalty)
    first = SQUEEZE / (COMPLIANCE + 1 / penalty) / penalty
    np.testing.assert_allclose(gaps(comm, made), -first * ratio**updates, rtol=1e-8)
    squeezed = SQUEEZE - first * ratio**updates
    np.testing.assert_allclose(pressures(comm, made), squeezed / COMPLIANCE, rtol=1e-8)
    assert len(report.augmentations) == updates


@pytest.mark.ranks
@pytest.mark.parametrize("augmentation", ["iteration", "loop"])
def test_augmentations_end_without_penetration(comm, augmentation):
    made, report = bars(
        comm, "augmented-lagrangian", penalty=1e12, augmentation=augmentation
    )
    np.testing.assert_allclose(pressures(comm, made), SQUEEZE / COMPLIANCE, rtol=1e-8)
    np.testing.assert_allclose(gaps(comm, made), 0.0, atol=1e-8 * SQUEEZE)
    assert 3 < len(report.augmentations) < 30
