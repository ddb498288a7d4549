"""Draining of places one above the other: the closed forms of plates and cylinders."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from castx.foundry.pools.draining import drained

pytestmark = pytest.mark.serial

BETA = 0.065
PLACES = 50


PLATE = [(1, 0.5, 0.955945), (1, 0.1, 0.860994), (1, 0.01, 0.741310)]
CYLINDER = [(2, 0.5, 0.913831), (2, 0.1, 0.741310), (2, 0.01, 0.549541)]


@pytest.mark.parametrize(("power", "width", "level"), [*PLATE, *CYLINDER])
@pytest.mark.parametrize("steps", [1, 7])
def test_what_freezes_sideways_sinks_by_the_power_of_its_width(power, width, level, steps):
    """h/h0 = (w/a)^β of a plate, (r/R)^(2β) of a cylinder, the same in one step and in several."""
    filled, areas = np.ones(PLACES), np.linspace(1.0, width, steps + 1) ** power
    for start, end in pairwise(areas):
        freezing = filled * (start - end)
        filled *= drained(filled * start, freezing, 0.0, BETA).left
    assert filled.mean() == pytest.approx(level, abs=5e-7)
    assert filled.mean() == pytest.approx(width ** (power * BETA), rel=1e-12)


def test_the_pipe_is_the_share_of_what_freezes():
    """β/(1 + β) of the whole, whatever freezes where."""
    liquid = np.random.default_rng(1).uniform(0.5, 2.0, PLACES)
    frozen = liquid * drained(liquid, liquid, 0.0, BETA).mean
    assert 1.0 - frozen.sum() / liquid.sum() == pytest.approx(0.06103286, abs=1e-8)


def test_what_freezes_below_comes_from_above():
    """Nothing freezes in the places: what is lacking below empties them from the top."""
    found = drained(np.array([1.0, 2.0, 4.0]), np.zeros(3), 40.0, BETA)
    np.testing.assert_allclose(found.left, [0.0, 1.0 - 0.5 * (40.0 * BETA - 1.0), 1.0])
    emptied = 1.0 / (40.0 * BETA)
    left = found.left[1]
    second = emptied + 0.5 * (1.0 + left) * (1.0 - emptied)
    np.testing.assert_allclose(found.mean, [0.5 * emptied, second, 1.0])


def test_places_empty_one_after_the_other():
    """Half of the time until then is its mean, and all before the one above is empty."""
    found = drained(np.array([1.0, 2.0, 4.0]), np.zeros(3), 80.0, BETA)
    first, second = 1.0 / (80.0 * BETA), 3.0 / (80.0 * BETA)
    left = 1.0 - (80.0 * BETA - 3.0) / 4.0
    np.testing.assert_allclose(found.left, [0.0, 0.0, left])
    third = second + 0.5 * (1.0 + left) * (1.0 - second)
    np.testing.assert_allclose(found.mean, [0.5 * first, 0.5 * (first + second), third])


def test_the_equation_holds_by_small_parts():
    """Against Euler's method: λ falls by β (R + λ ΔF)/G where all above is empty."""
    liquid, freezing, below, parts = np.array([0.3, 1.0]), np.array([0.2, 0.4]), 3.0, 40000
    left, mean = np.ones(2), np.zeros(2)
    for part in range(parts):
        now = liquid - freezing * (part + 0.5) / parts
        place = int(np.argmax(left > 0.0))
        rate = below + left[place:] @ freezing[place:]
        mean += left / parts
        left[place] = max(left[place] - BETA * rate / now[place] / parts, 0.0)
    found = drained(liquid, freezing, below, BETA)
    np.testing.assert_allclose(found.left, left, atol=3e-4)
    np.testing.assert_allclose(found.mean, mean, atol=3e-4)


def test_without_liquid_or_freezing_nothing_sinks():
    for liquid, freezing in ((np.zeros(2), np.zeros(2)), (np.ones(2), np.zeros(2))):
        np.testing.assert_array_equal(drained(liquid, freezing, 0.0, BETA).left, 1.0)


def test_places_that_lack_more_than_flows_sink_by_what_flows():
    """Of ΔF = 1 in one place 0.4 β flows: dλ/ds = -β (0.4 - (1 - λ))/G, by small steps."""
    left, mean, count = 1.0, 0.0, 20000
    for step in (np.arange(count) + 0.5) / count:
        mean += left / count
        left -= BETA * max(0.4 - (1.0 - left), 0.0) / (2.0 - step) / count
    found = drained(np.array([2.0]), np.array([1.0]), 0.4 - 1.0, BETA)
    np.testing.assert_allclose((found.left[0], found.mean[0]), (left, mean), rtol=1e-5)
    still = drained(np.array([2.0, 3.0]), np.array([1.0, 1.0]), -2.0, BETA)
    assert (still.left == 1.0).all() and (still.mean == 1.0).all()
