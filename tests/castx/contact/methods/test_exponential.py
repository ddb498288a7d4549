"""Softened contact: pressure by hand, its ends, and a block that rests on it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from castx.contact.choice import Contact
from castx.contact.methods.exponential import STEEPEST, ExponentialPairLaw, exponential_pair_law
from tests.elastic_bodies import blocks, body, elastic, fixed, problem, pushed

pytestmark = pytest.mark.serial

WEIGHT = 1e6
"""Pressure on the block [Pa]."""

CLEARANCE, STIFFNESS, AREA = 1e-5, np.array([2e9]), np.array([1e-4])


def force(gap: float, clearance: float = CLEARANCE) -> float:
    law, none = ExponentialPairLaw(clearance), np.zeros(1)
    return float(law.force(np.array([gap]), AREA, STIFFNESS, none)[0])


def slope(gap: float) -> float:
    law, none = ExponentialPairLaw(CLEARANCE), np.zeros(1)
    return float(law.slope(np.array([gap]), AREA, STIFFNESS, none)[0])


def test_force_by_hand():
    """ε S c = 20 kN; at g = 0, (e - 1)/(2e - 1) of it; at c/2, ½ (√e - 1)/(2e - 1)."""
    assert force(0.0) == pytest.approx(2e4 * (math.e - 1) / (2 * math.e - 1), rel=1e-14)
    half = 0.5 * (math.sqrt(math.e) - 1) / (2 * math.e - 1)
    assert force(CLEARANCE / 2) == pytest.approx(2e4 * half, rel=1e-13)


def test_it_begins_at_the_clearance_and_meets_the_penalty_at_closure():
    assert force(CLEARANCE) == pytest.approx(0.0, abs=1e-12 * 2e4)
    assert force(1.001 * CLEARANCE) < 0.0 < force(0.999 * CLEARANCE)
    assert slope(0.0) == pytest.approx(STIFFNESS[0], rel=1e-14)


def test_the_clearance_counts_and_has_a_default():
    assert force(8e-6, 2e-5) > force(8e-6, 1e-5) > 0.0 > force(8e-6, 5e-6)
    none = np.zeros(1)
    chosen, usual = exponential_pair_law({"clearance": 2e-5}), exponential_pair_law({})
    found = [law.force(np.array([8e-6]), AREA, STIFFNESS, none)[0] for law in (chosen, usual)]
    assert found == [force(8e-6, 2e-5), force(8e-6, 1e-5)]


def test_deep_penetration_goes_on_along_the_tangent():
    knee = (1.0 - STEEPEST) * CLEARANCE
    assert force(knee - 1e-5) - force(knee) == pytest.approx(1e-5 * slope(knee), rel=1e-12)
    assert force(-1.0) < 1e3 * STIFFNESS[0] * 1.0 * STEEPEST
    assert slope(-1.0) == slope(knee)


@pytest.mark.parametrize("clearance", [5e-6, 2e-5])
def test_a_block_floats_where_the_law_bears_it(comm, clearance):
    """The gap under a pressure p solves p = ε c x (e^x - 1)/(2e - 1) with x = 1 - g/c."""
    stiffness = 1e12
    settings = {"penalty": stiffness, "clearance": clearance}
    contact = Contact("upper", "base", "exponential", settings=settings)
    bodies = {
        "upper": body(elastic(70e9, 0.0), loads=(pushed("top", WEIGHT),)),
        "base": body(elastic(210e9, 0.0)),
    }
    held = {"base": [fixed("bottom", "all")]}
    made = problem(blocks(comm), bodies, held, [contact], tolerance=1e-10)
    made.equilibrium.solve(0.0)
    gaps, forces = made.pair_values()
    share = WEIGHT * (2.0 * math.e - 1.0) / (stiffness * clearance)
    x = brentq(lambda x: x * math.expm1(x) - share, 1e-9, 20.0)
    np.testing.assert_allclose(gaps, clearance * (1.0 - x), rtol=1e-6)
    np.testing.assert_allclose(forces, WEIGHT * made.gaps.areas, rtol=1e-6)
