"""Strain range of cycles of stress whose extremes are known."""

from __future__ import annotations

import numpy as np
import pytest

from castx.foundry.stress.strain_cycle import StrainCycle, distance
from castx.stateful import Numbering

pytestmark = pytest.mark.serial

CELLS = 3
SIZES = np.array([1.0, 2.0, 0.0])
TENSION = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
DRAWN = np.array([1.0, -0.5, -0.5, 0.0, 0.0, 0.0])
"""Viscoplastic strain of a bar that is drawn, of equivalent 1."""


def cycles():
    return StrainCycle(CELLS, Numbering("cells of die", np.arange(CELLS), CELLS, ("die",)))


def follow(found, cycle, path, plastic=0.0, ends=False):
    """Take stresses over E at 20 °C and 100 K per unit of them; the last may end the cycle."""
    for number, value in enumerate(path, 1):
        found.update(
            cycle, value * SIZES[:, None] * TENSION, np.tile(plastic * DRAWN, (CELLS, 1)),
            np.full(CELLS, 20.0 + 100.0 * value), ended=ends and number == len(path),
        )  # fmt: skip


def test_the_distance_is_the_equivalent_of_a_strain():
    """Of a drawn bar its strain, of shear γ/√3 with ε_xy = γ/2, of a volume nothing."""
    shear, volume = np.zeros((2, 6))
    shear[3], volume[:3] = 1.5, 7.0
    tensors = np.array([3.0 * DRAWN, shear, volume])
    np.testing.assert_allclose(distance(tensors, np.zeros((3, 6))), [3.0, np.sqrt(3), 0.0])


def test_tension_and_compression_add_up():
    """The von Mises stress alone would show the larger of both."""
    found = cycles()
    follow(found, 1, (0.0, -3e-3, -1e-3, 2e-3, 0.5e-3))
    np.testing.assert_allclose(found.strain_range, 5e-3 * SIZES)
    np.testing.assert_allclose(found.temperature[:2], 20.0 - 0.05)


def test_viscoplastic_strain_to_and_fro_counts_once():
    """A bar yields at ±σ_y between strains 0 and ε: its loop is ε wide, for any σ_y."""
    found = cycles()
    states = [(0.0, 0.0), (1e-3, 0.0), (1e-3, 5e-4), (-1e-3, 5e-4), (-1e-3, 0.0)]
    for stress, plastic in states:
        follow(found, 1, (stress,), plastic=plastic)
    np.testing.assert_allclose(found.strain_range, 2e-3 * SIZES + 5e-4)


def test_stress_against_the_flow_is_taken_off_it():
    """A clamped bar yields hot at -σ_h, and is drawn by what it has flowed as it cools.

    Nothing but its thermal strain of 3e-3 strains it; stress and flow of start and end alone would
    add up to 4e-3.
    """
    found = cycles()
    for stress, plastic in ((0.0, 0.0), (-1e-3, 0.0), (-1e-3, -2e-3), (2e-3, -2e-3)):
        follow(found, 1, (stress,), plastic=plastic)
    np.testing.assert_allclose(found.strain_range[0], 3e-3)


def test_shear_strain_has_an_equivalent_of_its_own():
    """γ_xy counts as γ/√3, with ε_xy = γ/2."""
    found, none = cycles(), np.zeros((CELLS, 6))
    sheared = none.copy()
    sheared[:, 3] = 0.5 * 3e-3
    for plastic in (none, sheared):
        found.update(1, none, plastic, np.zeros(CELLS))
    np.testing.assert_allclose(found.strain_range, 3e-3 / np.sqrt(3.0))


def test_the_last_whole_cycle_counts():
    """From the step with which it ends; the next one begins with the state that it leaves."""
    found = cycles()
    follow(found, 1, (0.0, -8e-3, 1e-3), ends=True)
    np.testing.assert_allclose(found.strain_range, 9e-3 * SIZES)
    follow(found, 2, (-2e-3,), plastic=-3e-4)
    np.testing.assert_allclose(found.strain_range, 9e-3 * SIZES)
    follow(found, 2, (0.0,), plastic=-3e-4, ends=True)
    np.testing.assert_allclose(found.strain_range, 3e-3 * SIZES + 3e-4)
    np.testing.assert_allclose(found.temperature[:2], 20.0 - 0.05)
    follow(found, 3, (5e-3,), plastic=7e-4)
    np.testing.assert_allclose(found.strain_range, 3e-3 * SIZES + 3e-4)
    np.testing.assert_allclose(found.temperature[:2], 20.0 - 0.05)


def test_a_bent_path_is_not_overestimated():
    generator = np.random.default_rng(3)
    found, path = cycles(), generator.normal(size=(60, CELLS, 6))
    for stress in path:
        found.update(1, stress, np.zeros((CELLS, 6)), np.zeros(CELLS))
    exact = 1.5 * np.max([distance(a, b) for a in path for b in path], axis=0)
    assert (found.strain_range <= exact + 1e-12).all()
    assert (found.strain_range >= 0.8 * exact).all()


def test_a_restored_cycle_goes_on():
    whole, first, second = cycles(), cycles(), cycles()
    path = [(1, 0.0), (1, -4e-3), (1, 1e-3), (2, 2e-3), (2, -1e-3), (3, 0.0)]
    last = (2, 4)
    for number, (cycle, value) in enumerate(path):
        follow(whole, cycle, (value,), ends=number in last)
    for number, (cycle, value) in enumerate(path[:4]):
        follow(first, cycle, (value,), ends=number in last)
    second.restore({name: saved.values for name, saved in first.saved().items()})
    for number, (cycle, value) in enumerate(path[4:], 4):
        follow(second, cycle, (value,), ends=number in last)
    np.testing.assert_array_equal(second.strain_range, whole.strain_range)
    np.testing.assert_array_equal(second.temperature, whole.temperature)
