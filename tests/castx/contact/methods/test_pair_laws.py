"""Every pair law: its slope against differences, its sign, a pair apart, and one value a pair."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.methods.registry import METHODS
from tests.contact_methods import FORCE_OF_GAP

pytestmark = pytest.mark.serial

AREAS = np.array([1e-4, 2e-4, 5e-5, 3e-4])
STIFFNESS = 1e11 * AREAS
GAPS = np.array([-3e-6, -1e-7, 2e-7, 5e-3])


def law_of(method: str):
    make = METHODS[method].pair_law
    assert make is not None
    return make({key.name: key.default for key in METHODS[method].keys})


@pytest.mark.parametrize("method", FORCE_OF_GAP)
@pytest.mark.parametrize("pressure", [0.0, 3e5])
def test_slope_against_differences(method, pressure):
    law, multipliers = law_of(method), pressure * AREAS
    step = 1e-9
    before, after = (
        law.force(GAPS + shift, AREAS, STIFFNESS, multipliers) for shift in (-step, step)
    )
    slope = law.slope(GAPS, AREAS, STIFFNESS, multipliers)
    np.testing.assert_allclose((before - after) / (2 * step), slope, rtol=1e-5, atol=1e-3)
    assert np.all(slope >= 0.0)


@pytest.mark.parametrize("method", FORCE_OF_GAP)
def test_pairs_that_penetrate_push_and_pairs_far_apart_do_not(method):
    forces = law_of(method).force(GAPS, AREAS, STIFFNESS, np.zeros(4))
    assert np.all(forces[:2] > 0.0) and forces[0] / AREAS[0] > forces[1] / AREAS[1]
    assert forces[3] <= 0.0


@pytest.mark.parametrize("method", FORCE_OF_GAP)
def test_a_linear_law_has_one_slope(method):
    law, none = law_of(method), np.zeros(4)
    slopes = [law.slope(gaps, AREAS, STIFFNESS, none) for gaps in (GAPS, GAPS - 1e-5)]
    assert law.is_linear == np.array_equal(*slopes)
