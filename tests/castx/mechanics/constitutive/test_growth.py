"""Solid that grows inside cells: shares, contraction where it happens, volume at birth."""

from __future__ import annotations

import numpy as np
import pytest

from castx.mechanics.constitutive.growth import (
    CellVolume,
    MetalNodes,
    Shares,
    contraction,
    in_the_solid,
    weighted_means,
)


@pytest.mark.serial
def test_shares_while_solid_grows_stays_and_melts():
    start = np.array([0.0, 0.2, 0.5, 0.8, 0.8, 0.0])
    end = np.array([0.4, 0.8, 0.5, 0.2, 0.0, 0.0])
    found = Shares.between(start, end)
    np.testing.assert_allclose(found.carried, [0.0, 0.25, 1.0, 1.0, 0.0, 0.0])
    np.testing.assert_allclose(found.strained, [0.5, 0.625, 1.0, 1.0, 0.0, 0.0])


def metal(nodes: int, seed: int) -> MetalNodes:
    random = np.random.default_rng(seed)
    return MetalNodes(random.random(nodes).round(1), 1e-3 * random.normal(size=nodes))


def test_a_cell_contracts_where_it_is_solid(points):
    nodes = points.cell_nodes.max() + 1
    start, end = metal(nodes, 1), metal(nodes, 2)
    found = contraction(points, start, end)
    for cell, corners in enumerate(points.cell_nodes):
        weight = np.maximum(start.share, end.share)[corners]
        change = (end.contraction - start.contraction)[corners]
        assert found[cell] == pytest.approx((weight * change).sum() / weight.sum(), rel=1e-12)
    liquid = MetalNodes(np.zeros(nodes), end.contraction)
    assert not contraction(points, liquid, liquid._replace(contraction=start.contraction)).any()
    # The contraction of a corner that is solid is that of the cell, however little solid it is.
    first = points.cell_nodes[0][0]
    one = np.zeros(nodes)
    one[first] = 0.01
    only = MetalNodes(one, end.contraction)
    found = contraction(points, MetalNodes(one, start.contraction), only)
    assert found[0] == pytest.approx((end.contraction - start.contraction)[first], rel=1e-12)


def test_values_of_the_solid_are_means_over_it(points):
    nodes = points.cell_nodes.max() + 1
    weight, values = metal(nodes, 3).share, 100.0 * np.random.default_rng(4).random(nodes)
    found = in_the_solid(points, values, weight)
    expected = points.from_nodes(weight * values) / points.from_nodes(weight)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    for whole in (np.zeros(nodes), np.ones(nodes)):
        np.testing.assert_array_equal(
            in_the_solid(points, values, whole), points.from_nodes(values)
        )
    assert not weighted_means(points, values, np.zeros(nodes)).any()


VOLUME = CellVolume(
    np.array([1e-3, 1e-3, -2e-3]), np.array([3e-3, 1.5e-3, 0.0]), np.array([2e7, -5e7, 1e6]),
    np.zeros(3),
)  # fmt: skip
SOFT = np.array([2e-11, 1e-11, 1.5e-11])


@pytest.mark.serial
@pytest.mark.parametrize(("start", "end"), [(0.0, 0.3), (0.2, 0.9), (0.0, 1.0)])
def test_new_solid_is_born_at_the_volume_and_under_the_pressure_that_are_there(start, end):
    """With the same pressure behind the step the cell wants the volume that it has.

    Solid that was there before wants its own, so that the mean of both is wanted.
    """
    shares = np.full(3, start), np.full(3, end)
    free = VOLUME.grown(*shares, SOFT, np.zeros(3))
    wanted = free + end * SOFT * VOLUME.mean_stress
    own = VOLUME.free + start * SOFT * VOLUME.mean_stress
    expected = start / end * own + (1 - start / end) * VOLUME.dilatation
    np.testing.assert_allclose(wanted, expected, rtol=1e-12)


@pytest.mark.serial
def test_what_melts_leaves_its_volume_and_contraction_is_added():
    shares, change = (np.full(3, 0.8), np.full(3, 0.3)), np.array([1e-4, 0.0, -1e-4])
    free = VOLUME.grown(*shares, SOFT, change)
    stored = 0.5 * SOFT * VOLUME.mean_stress
    np.testing.assert_allclose(free, VOLUME.free + stored + change, rtol=1e-12)
    same = VOLUME.grown(np.zeros(3), np.zeros(3), SOFT, np.zeros(3))
    np.testing.assert_array_equal(same, VOLUME.free)
