"""Arms that coarsen while metal cools at a constant rate, rests, and melts again."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.mechanics.mush.arms import RunningArms
from castx.mechanics.mush.metal import MushMetal
from castx.stateful import Numbering

pytestmark = pytest.mark.serial

METAL = MushMetal(0.06, 1e-3, 1e5, 0.98, 4e-5, 1 / 3, 600.0)
CORNERS = np.array([[0, 1]])


def arms(metal: MushMetal = METAL) -> RunningArms:
    return RunningArms(metal, CORNERS, Numbering("nodes", np.arange(2), 2, ("casting",)))


def followed(run: RunningArms, temperatures: list[float], step: float) -> list[float]:
    found = []
    for temperature in temperatures:
        found.append(float(run.begin(np.full(2, temperature), np.zeros(2), step)[0]))
        run.commit()
    return found


def test_constant_rate_has_the_spacing_of_its_rate():
    """2 K/s, with a liquidus that is passed within a step."""
    found = followed(arms(), [605.0, 601.0, 597.0, 593.0, 560.0 + 29.0], 2.0)
    np.testing.assert_allclose(found[2:], 4e-5 * 2.0 ** (-1 / 3), rtol=1e-12)
    assert found[0] == 4e-5


def test_arms_coarsen_at_rest_and_never_grow_finer():
    run = arms()
    found = followed(run, [601.0, 599.0, 599.0, 540.0], 1.0)
    since = 0.5 + 1.0  # seconds since the liquidus, 1 K below it
    assert found[2] == pytest.approx(4e-5 * (since / 1.0) ** (1 / 3))
    assert found[3] == found[2]
    assert followed(run, [601.0, 590.0], 1.0)[1] == pytest.approx(4e-5 * 11.0 ** (-1 / 3))


def test_mush_from_the_start_has_the_rate_of_its_first_step():
    found = followed(arms(), [590.0, 585.0], 1.0)
    assert found[1] == pytest.approx(4e-5 * 5.0 ** (-1 / 3))


def test_rest_just_below_the_liquidus_makes_no_coarse_arms():
    """Two seconds within 0.1 K, then 10 K/s: the rate over the first kelvin, not 0.05 K/s."""
    for step in (0.5, 0.125):
        slow = np.linspace(600.0, 599.9, round(2.0 / step) + 1).tolist()
        found = followed(arms(), [601.0, *slow], step)
        assert found[-1] == pytest.approx(4e-5 * (2.0 / 1.0) ** (1 / 3), rel=0.02)


@pytest.mark.parametrize("step", [0.5, 2.0, 3.0])
def test_arms_do_not_hang_on_steps_that_pass_the_least_cooling(step):
    """0.05 K/s to 0.5 K below the liquidus, then 0.5 K/s: 11 s over the first kelvin."""
    times = 10.0 + step * np.arange(-4, 5)
    course = np.interp(times, [-50.0, 10.0, 40.0], [602.5, 599.5, 584.5]).tolist()
    found = followed(arms(), course, step)
    assert found[-1] == pytest.approx(4e-5 * 11.0 ** (1 / 3), rel=1e-9)


@pytest.mark.parametrize("step", [0.5, 2.0, 3.0])
def test_arms_do_not_hang_on_steps_that_pass_the_liquidus(step):
    """10 K/s in the melt, 0.4 K/s in a mush that frees 24 K in each kelvin, as it freezes."""
    metal = replace(METAL, latent=240.0)
    times = 11.0 + step * np.arange(-1, 8)
    course = np.interp(times, [0.0, 10.0, 60.0], [700.0, 600.0, 580.0])
    run = arms(metal)
    for temperature in course:
        solid = np.full(2, max(0.0, (600.0 - temperature) / 10.0))
        found = float(run.begin(np.full(2, temperature), solid, step)[0])
        run.commit()
    assert found == pytest.approx(4e-5 * 2.5 ** (1 / 3), rel=1e-9)


def test_constant_spacing():
    metal = MushMetal(0.06, 1e-3, 1e5, 0.98, 4e-5, 0.0, 600.0)
    assert followed(arms(metal), [605.0, 550.0], 1.0) == [4e-5, 4e-5]


def test_a_step_that_is_rewound_or_restored_leaves_nothing():
    run, other = arms(), arms()
    followed(run, [601.0, 598.0], 1.0)
    other.restore({name: saved.values for name, saved in run.saved().items()})
    run.begin(np.full(2, 500.0), np.zeros(2), 1.0)
    run.rewind()
    assert followed(run, [597.0], 1.0) == followed(other, [597.0], 1.0)
