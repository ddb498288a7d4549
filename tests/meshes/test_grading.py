"""Spacing of nodes along a line."""

from itertools import pairwise

import numpy as np
import pytest

from castx.meshes.grading import (
    Sizing,
    between_walls,
    graded,
    graded_through,
    require_positive,
    uniform,
)

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "length, size, even, intervals",
    [(0.1, 0.01, False, 10), (0.1, 0.03, False, 4), (0.1, 0.03, True, 4), (0.1, 0.02, True, 6)],
)
def test_uniform_spacing_takes_the_fewest_intervals_within_the_size(length, size, even, intervals):
    positions = uniform(length, size, even)
    assert len(positions) == intervals + 1
    assert positions[0] == 0.0 and positions[-1] == length


def test_graded_spacing_starts_at_the_interface_size_and_ends_at_the_size():
    positions = graded(0.1, Sizing(0.01, 0.001))
    steps = np.diff(positions)
    assert positions[0] == 0.0 and positions[-1] == 0.1
    assert steps[0] == pytest.approx(0.001, rel=0.1)
    assert 0.8 * 0.01 < steps[-1] <= 0.01
    assert (np.diff(steps) > 0).all()


def test_graded_spacing_of_a_part_follows_the_sizes_of_the_whole():
    whole, part = graded(0.1, Sizing(0.01, 0.001)), graded(0.04, Sizing(0.01, 0.001), 0.1)
    assert part[-1] == 0.04
    assert part[: len(part) // 2] == pytest.approx(whole[: len(part) // 2], rel=0.1)
    assert np.diff(part)[-1] == pytest.approx(0.001 + 0.009 * 0.4, rel=0.2)


def test_a_higher_order_of_growth_keeps_the_cells_small_for_longer():
    linear, cubic = (graded(0.1, Sizing(0.01, 0.001, order)) for order in (1.0, 3.0))
    assert cubic[len(cubic) // 2] < 0.1 / 2
    assert np.searchsorted(cubic, 0.05) > 1.3 * np.searchsorted(linear, 0.05)


def test_positions_go_through_all_places_and_are_fine_at_each():
    places = np.array([0.0, 0.04, 0.1])
    even = graded_through(places, Sizing(0.01))
    np.testing.assert_allclose(even, np.linspace(0.0, 0.1, 11), atol=1e-15)
    found = graded_through(places, Sizing(0.01, 0.001))
    at = [int(np.flatnonzero(found == place)[0]) for place in places]
    sizes = np.diff(found)
    for start, end in pairwise(at):
        assert (end - start) % 2 == 0
        assert max(sizes[start], sizes[end - 1]) < 0.0015 < sizes[(start + end) // 2]
        np.testing.assert_allclose(sizes[start:end], sizes[start:end][::-1], rtol=1e-9)


def test_walls_stand_on_both_sides():
    found = between_walls(np.array([1.0, 2.0, 4.0]), np.array([0.0, 0.25, 1.0]))
    np.testing.assert_array_equal(found, [0.0, 0.75, 1.0, 2.0, 4.0, 4.25, 5.0])


@pytest.mark.parametrize(
    "sizes, text",
    [
        ((0.0,), "size must be positive, got 0 m"),
        ((0.01, 0.02), "interface_size must be positive and at most the size of 0.01 m, got 0.02"),
        ((0.01, 0.001, -1.0), "order_of_growth must be positive, got -1"),
    ],
)
def test_impossible_sizes_are_refused(sizes, text):
    with pytest.raises(ValueError, match=text):
        Sizing(*sizes)


def test_lengths_are_refused_by_name():
    with pytest.raises(ValueError, match="wall must be positive, got -1 m"):
        require_positive(radius=1.0, wall=-1.0)
