"""Sums over cells with samples: means of the volume, values round points, integrals."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.constitutive.integration_points import IntegrationPoints, VolumePoints
from castx.mechanics.constitutive.places import MetalPlaces

SOME = np.array([0, 3], dtype=np.int32)


def linear(body) -> np.ndarray:
    x, y = body.points[:, 0], body.points[:, 1]
    return 1.0 + 50.0 * x - 20.0 * y


@pytest.mark.ranks
@pytest.mark.parametrize(
    ("points", "degree"), [(IntegrationPoints, 1), (IntegrationPoints, 2), (VolumePoints, 2)]
)
def test_linear_values_are_those_without_samples(comm, body, points, degree):
    """Means, and integrals; and round points as far as samples lie evenly about them."""
    made = points(body, "plane-strain", degree)
    places, values = MetalPlaces(made, SOME), linear(body)
    everywhere = places.from_nodes(values)
    assert len(everywhere) > len(values) and places.sampled
    expected = made.volume_means(values)
    tolerance = 1e-12 if degree == 1 else 0.05
    exact = points is IntegrationPoints
    np.testing.assert_allclose(
        places.volume_means(everywhere), expected, rtol=1e-12 if exact else tolerance
    )
    np.testing.assert_allclose(
        places.at_points(everywhere), made.from_nodes(values), rtol=tolerance
    )
    np.testing.assert_allclose(
        places.integrals([everywhere]), made.integrals([values]), rtol=1e-3 * tolerance
    )


@pytest.mark.serial
def test_samples_decide_in_their_cells_and_nodes_in_others(body, points):
    places, nodes = MetalPlaces(points, SOME), np.zeros(len(body.points))
    samples = np.ones_like(places.samples_from_nodes(nodes))
    found = places.volume_means(places.joined(nodes, samples))
    expected = np.zeros(points.cells)
    expected[SOME] = 1.0
    np.testing.assert_allclose(found, expected, atol=1e-12)
    none = MetalPlaces(points, SOME[:0])
    assert not none.sampled and none.joined(nodes, np.empty(0)) is nodes
    np.testing.assert_array_equal(none.volume_means(nodes), points.volume_means(nodes))


@pytest.mark.ranks
def test_nodes_leave_nothing_in_integrals_over_cells_with_samples(comm, body, points):
    """Not even rounding: sums that vanish are divided by each other."""
    shares = np.random.default_rng(3).random(len(body.points))
    everywhere = MetalPlaces(points, np.arange(points.cells, dtype=np.int32))
    none = np.zeros_like(everywhere.samples_from_nodes(shares))
    np.testing.assert_array_equal(everywhere.integrals([everywhere.joined(shares, none)]), [0.0])
    some = MetalPlaces(points, SOME)
    without = some.joined(shares, np.zeros_like(some.samples_from_nodes(shares)))
    bears = comm.allreduce(sum(
        points.weights[cell].sum() * shares[points.cell_nodes[cell]].mean()
        for cell in range(points.owned_cells) if cell not in SOME
    ))  # fmt: skip
    np.testing.assert_allclose(some.integrals([without]), [bears], rtol=1e-12)


@pytest.mark.serial
def test_a_sample_counts_for_the_nearest_point_alone(body):
    """Of one that is hot next to a point, the others of its cell know nothing."""
    made = VolumePoints(body, "plane-strain", 2)
    places = MetalPlaces(made, SOME[:1])
    count = len(places.samples_from_nodes(np.zeros(len(body.points))))
    touched = np.zeros(made.per_cell, dtype=int)
    for sample in range(count):
        values = np.zeros(count)
        values[sample] = 1.0
        round_points = places.at_points(places.joined(np.zeros(len(body.points)), values))
        mine = made.by_cell(round_points)[SOME[0]]
        touched += mine > 0.0
        assert not made.by_cell(round_points)[1:].any()
        assert 1 <= np.count_nonzero(mine) <= 3
    assert touched.min() >= 2


@pytest.mark.ranks
@pytest.mark.parametrize("points", [VolumePoints, IntegrationPoints])
def test_points_of_a_cell_that_holds_a_front_have_its_mean(body, points):
    """Where they have volumes of their own; in liquid and behind the front they keep theirs."""
    made, x = points(body, "axisymmetric", 2), body.points[:, 0]
    places = MetalPlaces(made, np.arange(made.cells, dtype=np.int32))
    values, there = places.from_nodes(linear(body)), places.from_nodes(x)
    before, volumes = places.at_points(values), places.volume_means(values)
    melted, frozen = (np.clip((there - x0) / 0.005, 0.0, 1.0) for x0 in (0.012, 0.007))
    left = np.round(1e3 * x[made.cell_nodes].min(axis=1))
    means = made.from_cells(linear(body)[made.cell_nodes].mean(axis=1))
    for shares, cells in (([frozen, frozen], [5.0]), ([melted, frozen], [5.0, 10.0])):
        places.follow_fronts(shares)
        after = places.at_points(values)
        held = made.from_cells(np.isin(left, cells)) & (points is VolumePoints)
        np.testing.assert_array_equal(after[~held], before[~held])
        np.testing.assert_allclose(after[held], means[held], rtol=1e-12)
        own = after if points is VolumePoints else volumes
        np.testing.assert_array_equal(places.volume_means(values), own)
