"""Solid that grows inside cells: shares, contraction where it happens, volume at birth."""

from __future__ import annotations

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.mechanics.constitutive.growth import (
    CellVolume,
    Freezing,
    MetalNodes,
    PlateauFront,
    Shares,
    growth,
    in_the_solid,
)
from castx.mechanics.constitutive.places import MetalPlaces


@pytest.mark.serial
def test_shares_while_solid_grows_stays_and_melts():
    start = np.array([0.0, 0.2, 0.5, 0.8, 0.8, 0.0])
    end = np.array([0.4, 0.8, 0.5, 0.2, 0.0, 0.0])
    found = Shares.between(start, end, np.array([0.1, 0.6, 0.5, 0.5, 0.4, 0.0]))
    np.testing.assert_allclose(found.carried, [0.0, 0.25, 1.0, 1.0, 0.0, 0.0])
    np.testing.assert_allclose(found.strained, [0.25, 0.75, 1.0, 1.0, 0.0, 0.0])


def of(share: FloatArray, contraction: FloatArray) -> MetalNodes:
    """Return metal of which the temperature does not matter."""
    return MetalNodes(share, contraction, np.zeros_like(share))


def metal(nodes: int, seed: int) -> MetalNodes:
    random = np.random.default_rng(seed)
    return of(random.random(nodes).round(1), 1e-3 * random.normal(size=nodes))


FROZEN = -2e-4
"""Strain of contraction at which metal of these tests becomes solid."""


def freezing(nodes: int, born: float = 0.0, frozen: float = FROZEN) -> Freezing:
    """Return the contraction at both ends of the mush, the same at all nodes."""
    return Freezing(np.full(nodes, born), np.full(nodes, frozen))


def test_a_cell_contracts_where_it_bears(points):
    """Mush and solid: Σ w dc/Σ w with the mean share of each corner."""
    nodes = points.cell_nodes.max() + 1
    start, end = metal(nodes, 1), metal(nodes, 2)
    start.share[::3] = end.share[::3] = 1.0
    mushy = (start.share < 1) & (end.share < 1)
    solid = (start.share == 1) & (end.share == 1)
    start.share[~mushy & ~solid] = end.share[~mushy & ~solid] = 0.4
    found = growth(points, [start, end], freezing(nodes))
    mean = 0.5 * (start.share + end.share)
    np.testing.assert_allclose(found.strained, mean, rtol=1e-12)
    cells = found.along(points)
    for cell, corners in enumerate(points.cell_nodes):
        change = (end.contraction - start.contraction)[corners]
        expected = (mean[corners] * change).sum() / mean[corners].sum()
        assert cells[cell] == pytest.approx(expected, rel=1e-12)
        assert found.across(points)[cell] == pytest.approx(change.mean(), rel=1e-12)
    liquid = of(np.zeros(nodes), end.contraction)
    other = liquid._replace(contraction=start.contraction)
    none = growth(points, [liquid, other], freezing(nodes))
    assert not none.along(points).any()
    # The contraction of a corner that is solid is that of the cell, however little solid it is.
    first = points.cell_nodes[0][0]
    one = np.zeros(nodes)
    one[first] = 0.01
    only = [of(one, state.contraction) for state in (start, end)]
    cells = growth(points, only, freezing(nodes)).along(points)
    assert cells[0] == pytest.approx((end.contraction - start.contraction)[first], rel=1e-12)


def test_without_contraction_the_share_is_the_mean_over_the_states(points):
    nodes = points.cell_nodes.max() + 1
    passed = [of(np.full(nodes, w), np.zeros(nodes)) for w in (0.0, 0.2, 0.9)]
    found = growth(points, passed, freezing(nodes, frozen=0.0))
    np.testing.assert_allclose(found.strained, (0.1 + 0.55) / 2, rtol=1e-12)
    assert not found.weighted.any()


@pytest.mark.parametrize("melts", [False, True])
def test_what_cooled_before_it_bears_does_not_count(points, melts):
    """A cell that begins to bear does not contract at once by all that it cooled as a liquid.

    Born at -1e-4, which lies a tenth behind the start of the step or at any other part of it: by
    the mean share of what is left, and for a share of almost none by almost nothing.
    """
    nodes = points.cell_nodes.max() + 1
    born = freezing(nodes, born=-1e-4)
    for share in (0.5, 1e-5):
        end = of(np.full(nodes, share), np.full(nodes, -1e-4 * (1.0 + share)))
        for before in (0.0, -0.9e-4, -1e-4):
            passed = [of(np.zeros(nodes), np.full(nodes, before)), end]
            sign = -1.0 if melts else 1.0
            found = growth(points, passed[::-1] if melts else passed, born)
            np.testing.assert_allclose(found.along(points), -sign * 1e-4 * share, rtol=1e-9)
    # Through the whole mush in one step: half of what it contracts as mush, all of it as a solid.
    cold = of(np.ones(nodes), np.full(nodes, -5e-4))
    found = growth(points, [of(np.zeros(nodes), np.zeros(nodes)), cold], born)
    np.testing.assert_allclose(found.weighted, -0.5 * 1e-4 - 3e-4, rtol=1e-12)


@pytest.mark.parametrize("isothermal", [False, True])
@pytest.mark.parametrize("melts", [False, True])
def test_metal_that_becomes_solid_contracts_after_that(points, melts, isothermal):
    """From w = 0.5 to the solid by half a share in the mean, and below the solidus by all of it.

    All metal alike contracts by as much as it does, in a step of any size.
    """
    nodes = points.cell_nodes.max() + 1
    mushy = of(np.full(nodes, 0.5), np.full(nodes, -1e-4))
    cold = of(np.ones(nodes), np.full(nodes, -5e-4))
    passed = [cold, mushy] if melts else [mushy, cold]
    found = growth(points, passed, freezing(nodes), isothermal=isothermal)
    np.testing.assert_allclose(found.along(points), 4e-4 if melts else -4e-4, rtol=1e-12)
    np.testing.assert_allclose(found.strained, (1e-4 * 0.75 + 3e-4) / 4e-4, rtol=1e-12)


def test_a_skin_contracts_by_what_there_was_of_it(points):
    """The states inside a step count: half of the cooling passed before anything froze beside."""
    nodes = points.cell_nodes.max() + 1
    first = points.cell_nodes[0][0]
    skin, both = np.zeros(nodes), np.ones(nodes)
    skin[first] = 1.0
    passed = [
        of(skin, np.full(nodes, FROZEN)),
        of(skin, np.where(skin == 1, -6e-4, FROZEN)),
        of(both, np.where(skin == 1, -1e-3, FROZEN)),
    ]
    wide, narrow = (
        growth(points, states, freezing(nodes, born=FROZEN)) for states in (passed, passed[::2])
    )
    beside = np.delete(wide.strained, first), np.delete(narrow.strained, first)
    own, rest = points.integrals([skin, 1.0 - skin])
    first_part, second_part = 1.0, own / (own + 0.5 * rest)
    expected = 0.5 * second_part / (first_part + second_part)
    np.testing.assert_allclose(beside[0], expected, rtol=1e-12)
    np.testing.assert_allclose(beside[1], 0.5, rtol=1e-12)
    for found in (wide, narrow):
        assert found.weighted[first] == pytest.approx(-8e-4, rel=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize("seed", [1, 6, 8])
def test_what_bears_at_nodes_alone_strains_no_samples(points, seed):
    """Nodes come to bear before any sample does: what they contract is in no cell with samples."""
    places = MetalPlaces(points, np.arange(points.cells, dtype=np.int32))
    random, count = np.random.default_rng(seed), points.cell_nodes.max() + 1
    inside = np.ones_like(places.samples_from_nodes(np.zeros(count)))
    passed = [
        of(
            places.joined(share * random.random(count), bears * inside),
            np.full(count + len(inside), contraction),
        )
        for share, bears, contraction in ((0.0, 0.0, 0.0), (0.1, 0.0, -4e-5), (0.3, 0.2, -1e-4))
    ]
    found = growth(places, passed, freezing(count + len(inside)))
    np.testing.assert_allclose(found.strained[count:], 0.1, rtol=1e-12)


@pytest.mark.ranks
def test_what_is_strained_does_not_hang_on_the_ranks(comm, body, points):
    """A skin of half of the plate cools first, then the other half freezes beside it."""
    x = body.nodes.tabulate_dof_coordinates()[:, 0]
    skin, both = (x < 0.012).astype(float), np.ones(len(x))
    passed = [
        of(skin, np.full(len(x), FROZEN)),
        of(skin, np.where(skin == 1, -6e-4, FROZEN)),
        of(both, np.where(skin == 1, -8e-4, FROZEN)),
    ]
    found = growth(points, passed, freezing(len(x), born=FROZEN))
    # Of 20 mm the skin has 10 and half of the next cell of 5; of the rest half bears in the mean.
    share = 12.5 / 20.0
    strains = 4e-4, 2e-4 * share / (share + 0.5 * (1.0 - share))
    expected = 0.5 * strains[1] / sum(strains)
    beside = found.strained[skin == 0]
    np.testing.assert_allclose(beside, expected, rtol=1e-12)
    assert comm.allreduce(len(beside)) > 0


def test_solid_behind_a_front_is_strained_as_it_was_at_the_start(points):
    """Temperatures of an implicit Euler step belong to its middle, the front to its end."""
    nodes = points.cell_nodes.max() + 1
    first = points.cell_nodes[0][0]
    skin, more = np.full(nodes, 0.2), np.full(nodes, 0.6)
    skin[first] = more[first] = 1.0
    cold = np.where(skin == 1, -4e-4, FROZEN)
    passed = [of(skin, np.full(nodes, FROZEN)), of(more, cold)]
    for isothermal, share in ((False, 0.4), (True, 0.2)):
        found = growth(points, passed, freezing(nodes, born=FROZEN), isothermal=isothermal)
        np.testing.assert_allclose(np.delete(found.strained, first), share, rtol=1e-12)
    passed[0].share[skin < 1] = 0.0
    found = growth(points, passed, freezing(nodes, born=FROZEN), isothermal=True)
    np.testing.assert_allclose(np.delete(found.strained, first), 0.15, rtol=1e-12)


@pytest.mark.parametrize("melts", [False, True])
def test_a_front_of_an_alloy_contracts_at_its_middle_share(points, melts):
    """A plateau from w = 0.2 to the solid: (0.2 + 1)/2 of what each share of it contracts.

    Before that the mean share of the mush counts.
    """
    nodes = points.cell_nodes.max() + 1
    slope, front = -1e-3, PlateauFront(0.2, 1.0, -1e-3)
    for share, later, amount in (
        (0.3, 0.5, 0.2 * 0.6), (0.0, 0.2, 0.2 * 0.1), (0.1, 0.4, 0.1 * 0.15 + 0.2 * 0.6),
    ):  # fmt: skip
        passed = [of(np.full(nodes, w), np.full(nodes, slope * w)) for w in (share, later)]
        if melts:
            passed, amount = passed[::-1], -amount
        found = growth(points, passed, freezing(nodes, frozen=slope), fronts=[front])
        np.testing.assert_allclose(found.weighted, slope * amount, rtol=1e-12)
        np.testing.assert_allclose(found.strained, 0.5 * (share + later), rtol=1e-12)
    # From the plateau into the cold: what is solid contracts wholly below the solidus.
    last = [of(np.full(nodes, w), np.full(nodes, slope * c)) for w, c in ((0.5, 0.5), (1.0, 1.5))]
    found = growth(points, last, freezing(nodes, frozen=slope), fronts=[front])
    np.testing.assert_allclose(found.weighted, slope * (0.5 * 0.6 + 0.5), rtol=1e-12)


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
    assert not points.volume_means(values, np.zeros(nodes)).any()


VOLUME = CellVolume(
    np.array([1e-3, 1e-3, -2e-3]), np.array([3e-3, 1.5e-3, 0.0]), np.array([2e7, -5e7, 1e6]),
    np.zeros(3),
)  # fmt: skip
SOFT = np.array([2e-11, 1e-11, 1.5e-11])


@pytest.mark.serial
@pytest.mark.parametrize(
    ("start", "mean", "end"), [(0.0, 0.1, 0.3), (0.2, 0.9, 0.9), (0.0, 0.5, 1.0)]
)
def test_new_solid_is_born_at_the_volume_and_under_the_pressure_that_are_there(start, mean, end):
    """With the same pressure behind the step the cell wants the volume that it has.

    Solid that was there before wants its own, so that the mean of both is wanted. A change of the
    pressure meets the share that is there meanwhile.
    """
    shares = np.full(3, start), np.full(3, end)
    free = VOLUME.grown(*shares, np.full(3, mean), SOFT, np.zeros(3))
    wanted = free + mean * SOFT * VOLUME.mean_stress
    own = VOLUME.free + start * SOFT * VOLUME.mean_stress
    expected = start / end * own + (1 - start / end) * VOLUME.dilatation
    np.testing.assert_allclose(wanted, expected, rtol=1e-12)


@pytest.mark.serial
def test_what_melts_leaves_its_volume_and_contraction_is_added():
    shares = np.full(3, 0.8), np.full(3, 0.3), np.full(3, 0.3)
    change = np.array([1e-4, 0.0, -1e-4])
    free = VOLUME.grown(*shares, SOFT, change)
    stored = 0.5 * SOFT * VOLUME.mean_stress
    np.testing.assert_allclose(free, VOLUME.free + stored + change, rtol=1e-12)
    same = VOLUME.grown(*np.zeros((3, 3)), SOFT, np.zeros(3))
    np.testing.assert_array_equal(same, VOLUME.free)
