"""Content and pores of cells by hand: five cells of 1, 2, 3, 4, 5 m³, s = 10 %, fed until 0.6."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.mechanics.liquid.content import Content
from castx.mechanics.liquid.feeding_paths import CutOff
from castx.stateful import Numbering

VOLUMES = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
S, COHERENCY = 0.1, 0.6
ONE = np.array([True])


def content() -> Content:
    numbering = Numbering("cells of casting", np.arange(5), 5, ("casting",))
    return Content(MPI.COMM_SELF, numbering, VOLUMES)


def throughout(region) -> CutOff:
    """Return regions that were cut off from the start of the step."""
    return CutOff.throughout(np.array(region, dtype=np.int32))


def begin(cells: Content, fraction: list[float], region: list[int], solid=None, theta=0.0) -> None:
    """Start a trial step with solid fractions and cut-off regions; solid grows from 0.6 on."""
    f = np.array(fraction)
    liquid = f < COHERENCY if solid is None else ~np.array(solid, dtype=bool)
    shrunk = S * np.minimum(f, COHERENCY)
    cells.begin(throughout(region), liquid, shrunk, np.zeros(5), np.full(5, theta))


def commit(cells: Content, dilatation: list[float] | float = 0.0, porous=ONE) -> None:
    cells.commit(np.full(5, dilatation), porous[: len(cells.pockets)])


@pytest.mark.serial
def test_a_fed_region_demands_what_it_is_given() -> None:
    cells = content()
    begin(cells, [0.0] * 5, [-1] * 5)
    begin(cells, [0.2, 0.4, 0.6, 0.9, 1.0], [-1] * 5)
    commit(cells)
    wanted = S * (VOLUMES @ [0.2, 0.4, 0.6, 0.6, 0.6])
    assert (cells.demand, cells.fed, cells.void) == pytest.approx((wanted, wanted, 0.0), rel=1e-14)


@pytest.mark.serial
def test_a_sealed_pocket_in_rigid_walls_ends_with_all_its_demand_as_pores() -> None:
    """Also in cells that freeze, those that freeze last included; volumes are never forgotten."""
    cells = content()
    begin(cells, [0.0] * 5, [0] * 5)
    history = (
        ([0.3, 0.2, 0.1, 0.1, 0.0], [0, 0, 0, 0, 0]),
        ([0.7, 0.5, 0.3, 0.2, 0.1], [-1, 0, 0, 0, 0]),
        ([1.0, 1.0, 0.5, 0.4, 0.3], [-1, -1, 0, 0, 0]),
        ([1.0, 1.0, 1.0, 1.0, 1.0], [-1] * 5),
    )
    for fraction, pocket in history:
        begin(cells, fraction, pocket)
        expected = S * (VOLUMES @ np.minimum(fraction, COHERENCY))
        commit(cells)
        assert cells.void == pytest.approx(expected, rel=1e-13)
        assert cells.demand == pytest.approx(expected, rel=1e-13)
    assert cells.fed == 0.0
    pores = cells.saved()["pores"].values
    assert VOLUMES @ pores == pytest.approx(0.06 * VOLUMES.sum(), rel=1e-13)
    assert (pores > 0).all() and (np.diff(pores) >= -1e-15).all()  # the last to freeze have most


@pytest.mark.serial
def test_walls_that_give_way_take_from_the_void_which_is_filled_before_they_resist() -> None:
    cells = content()
    begin(cells, [0.0] * 5, [0] * 5)
    begin(cells, [0.3] * 5, [0] * 5)
    np.testing.assert_allclose(cells.void_fraction(np.full(5, -0.01)), [0.02], rtol=1e-14)
    commit(cells, -0.01)
    assert cells.void == pytest.approx(0.02 * 15, rel=1e-14)
    for theta in (-0.02, -0.03, -0.04):
        begin(cells, [0.3] * 5, [0] * 5)
        np.testing.assert_allclose(
            cells.void_fraction(np.full(5, theta)), [theta + 0.03], rtol=1e-13, atol=1e-17
        )
    commit(cells, -0.03, ~ONE)
    assert cells.void == 0.0
    np.testing.assert_allclose(cells.saved()["content"].values, -0.03, rtol=1e-13)


@pytest.mark.serial
@pytest.mark.parametrize("porous", [ONE, ~ONE], ids=["porous", "full"])
def test_liquid_flows_to_where_its_pocket_has_room(porous) -> None:
    """The cells of a pocket are full at their own volumes, but for the void of all of it."""
    cells = content()
    begin(cells, [0.0] * 5, [0, 0, 0, 1, -1])
    begin(cells, [0.3] * 5, [0, 0, 0, 1, -1])
    dilatation = np.array([0.04, -0.02, 0.01, 0.05, 0.007])
    void = cells.void_fraction(dilatation)
    mean = VOLUMES[:3] @ dilatation[:3] / 6.0
    np.testing.assert_allclose(void, [mean + 0.03, 0.05 + 0.03], rtol=1e-13)
    cells.commit(dilatation, np.concatenate([porous, ~porous]))
    full, pores = (cells.saved()[name].values for name in ("content", "pores"))
    np.testing.assert_allclose(full[:3], dilatation[:3] - void[0], rtol=1e-13)
    np.testing.assert_allclose(full[3:], [0.05 - void[1], 0.0], rtol=1e-13)
    assert VOLUMES[:3] @ full[:3] == pytest.approx(-0.03 * 6.0, rel=1e-13)  # the same metal
    expected = np.where([*[porous[0]] * 3, ~porous[0], False], [*[void[0]] * 3, void[1], 0.0], 0.0)
    np.testing.assert_allclose(pores, expected, rtol=1e-13)
    # Which of its cells is how large is no change of the pocket, and nothing is booked.
    begin(cells, [0.3] * 5, [0, 0, 0, 1, -1])
    np.testing.assert_allclose(cells.void_fraction(dilatation), void, rtol=1e-13)
    np.testing.assert_allclose(cells.void_fraction(np.full(5, mean)), [void[0], mean + 0.03])


@pytest.mark.serial
def test_a_cell_that_freezes_keeps_its_share_and_draws_what_it_lacks_from_the_pocket() -> None:
    cells = content()
    begin(cells, [0.0] * 5, [0] * 5)
    begin(cells, [0.5] * 5, [0] * 5)
    commit(cells, [0.02, 0.0, 0.0, 0.0, -0.004])  # no volume changes in all: void 0.05 · 15
    begin(cells, [0.8, 0.5, 0.5, 0.5, 0.5], [-1, 0, 0, 0, 0])
    # Its last 0.1 · s are drawn from the other 14 m³.
    void = cells.void_fraction(np.array([0.02, 0.0, 0.0, 0.0, -0.004]))
    np.testing.assert_allclose(14 * void, 0.05 * 14 + 0.01 * 1, rtol=1e-13)


@pytest.mark.serial
def test_a_pocket_that_is_reached_again_is_filled_and_one_that_melts_has_its_pores_again() -> None:
    cells = content()
    begin(cells, [0.0] * 5, [0] * 5)
    begin(cells, [0.4] * 5, [0] * 5)
    commit(cells)
    begin(cells, [1.0] * 5, [-1] * 5)
    commit(cells)
    assert cells.void == pytest.approx(0.06 * 15, rel=1e-13)
    begin(cells, [0.2] * 5, [0] * 5)
    np.testing.assert_allclose(cells.void_fraction(np.zeros(5)), [0.02], rtol=1e-12)
    commit(cells)
    begin(cells, [0.2] * 5, [-1] * 5)
    commit(cells)
    assert cells.void == 0.0
    assert cells.fed == pytest.approx(0.02 * 15, rel=1e-12)
    assert cells.demand == pytest.approx(cells.fed, rel=1e-12)


@pytest.mark.serial
def test_graphite_fills_pores_and_then_swells_the_cells_that_freeze_alone() -> None:
    cells = content()
    cells.begin(throughout([0] * 5), np.ones(5, bool), np.zeros(5), np.zeros(5), np.zeros(5))
    cells.begin(
        throughout([-1] * 5), np.zeros(5, bool), np.full(5, -0.006), np.zeros(5), np.zeros(5)
    )
    np.testing.assert_allclose(cells.swelling, 0.006, rtol=1e-14)
    cells.commit(np.full(5, 0.01), np.zeros(0, bool))
    assert cells.void == 0.0
    assert cells.demand == pytest.approx(-0.006 * 15, rel=1e-14)
    cells = content()
    begin(cells, [0.0] * 5, [0] * 5, [True] * 5)
    begin(cells, [0.2] * 5, [0] * 5, [True] * 5)
    commit(cells)
    assert cells.void == pytest.approx(0.02 * 15, rel=1e-13)
    cells.begin(
        throughout([0] * 5), np.zeros(5, bool), np.full(5, -0.005), np.zeros(5), np.zeros(5)
    )
    np.testing.assert_allclose(cells.swelling, 0.005, rtol=1e-13)
    commit(cells)
    assert cells.void == 0.0


@pytest.mark.serial
def test_cells_that_freeze_round_a_pool_draw_from_it_as_long_as_they_freeze() -> None:
    cells = content()
    begin(cells, [0.0] * 5, [0] * 5)
    commit(cells)
    for fraction in ([0.2, 0.1, 0.1, 0.1, 0.1], [0.5, 0.2, 0.1, 0.1, 0.1]):
        begin(cells, fraction, [0] * 5, [True, False, False, False, False])
        expected = S * (VOLUMES @ fraction)
        np.testing.assert_allclose(14 * cells.void_fraction(np.zeros(5)), expected, rtol=1e-12)
        commit(cells)
        assert cells.void == pytest.approx(expected, rel=1e-12) and cells.fed == 0.0
    np.testing.assert_allclose(cells.pockets, [14.0])


@pytest.mark.serial
def test_without_a_pool_pores_open_in_the_cells_that_freeze() -> None:
    """Two regions: one has a pool, and is the only pocket; in the other all cells hold solid."""
    cells = content()
    begin(cells, [0.0] * 5, [0, 0, 1, 1, 1], [False, False, True, True, True])
    begin(cells, [0.1, 0.1, 0.2, 0.3, 0.4], [0, 0, 1, 1, 1], [False, False, True, True, True])
    np.testing.assert_array_equal(cells.pocket, [0, 0, -1, -1, -1])
    np.testing.assert_allclose(cells.pockets, [3.0])
    commit(cells)
    pores = cells.saved()["pores"].values
    np.testing.assert_allclose(pores, [0.01, 0.01, 0.02, 0.03, 0.04], rtol=1e-12)
    assert cells.fed == 0.0 and not cells.swelling.any()
    assert cells.void == pytest.approx(cells.demand, rel=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize("seed", range(20))
def test_demand_is_fed_or_a_void_in_rigid_walls(seed: int) -> None:
    """While solid grows and melts, regions are cut off, reached again, and lose their pools."""
    random, cells = np.random.default_rng(seed), content()
    fraction = np.zeros(5)
    begin(cells, list(fraction), [-1] * 5)
    for _ in range(12):
        fraction = np.clip(fraction + random.choice([0.0, 0.1, 0.2, -0.05], 5), 0.0, 1.0)
        wet, cut = fraction < COHERENCY, random.random() < 0.7
        region = np.where(wet & cut, np.array([0, 0, 1, 1, 1]), -1)
        count = 1 + region.max()
        if count == 2 and not (region == 0).any():
            region[region == 1] = 0
        begin(cells, list(fraction), list(region), fraction > 0.25)
        if cells.swelling.any() or (cells.void_fraction(np.zeros(5)) < 0.0).any():
            break  # rigid walls would not hold it
        commit(cells, 0.0, np.ones(5, dtype=bool))
        assert cells.demand == pytest.approx(cells.fed + cells.void, rel=1e-10, abs=1e-12)
        assert cells.void >= -1e-15


@pytest.mark.serial
@pytest.mark.parametrize("seed", range(40))
def test_demand_is_fed_or_a_void_or_what_walls_give_way(seed: int) -> None:
    """While solid grows and melts, regions are cut off, part, meet and lose their pools.

    The walls give way where the cells of pools lose volume, and those that swell push them away.
    """
    random, cells = np.random.default_rng(seed), content()
    fraction: FloatArray = np.zeros(5)
    theta: FloatArray = np.zeros(5)
    begin(cells, list(fraction), [-1] * 5)
    walls = 0.0
    for _ in range(25):
        fraction = np.clip(fraction + random.choice([0.0, 0.1, 0.3, -0.2], 5), 0.0, 1.0)
        region = np.where(fraction < COHERENCY, random.integers(-1, 2, 5), -1)
        region[region >= 0] = np.unique(region[region >= 0], return_inverse=True)[1]
        sign = random.choice([1.0, 1.0, 1.0, -1.0])  # shrinks, or swells again
        shrunk = sign * S * np.minimum(fraction, COHERENCY)
        cells.begin(throughout(region), fraction <= 0.25, shrunk, np.zeros(len(theta)), theta)
        before, theta = theta, theta + 0.01 * random.standard_normal(5)
        filled = cells.void_fraction(theta)
        porous = (filled > 0.0) & (random.random(len(filled)) < 0.8)
        pool = cells.pocket >= 0
        # Walls close on what is left of a full pocket.
        theta[pool] -= np.where(porous, 0.0, filled)[cells.pocket[pool]]
        walls += float(VOLUMES[pool] @ (before - theta)[pool] - VOLUMES @ cells.swelling)
        assert (cells.swelling >= 0.0).all() and not cells.swelling[fraction <= 0.25].any()
        cells.commit(theta, porous)
        assert cells.demand == pytest.approx(VOLUMES @ shrunk, rel=1e-10, abs=1e-12)
        assert cells.demand == pytest.approx(cells.fed + cells.void + walls, rel=1e-10, abs=1e-12)
        assert cells.void >= -1e-15


@pytest.mark.serial
def test_a_body_that_starts_solid_is_full_as_it_is() -> None:
    """What froze before the start is no demand."""
    cells = content()
    begin(cells, [1.0] * 5, [-1] * 5)
    commit(cells)
    assert (cells.demand, cells.fed, cells.void) == (0.0, 0.0, 0.0)


@pytest.mark.serial
def test_the_state_comes_back() -> None:
    cells, other = content(), content()
    begin(cells, [0.0] * 5, [0, 0, 1, 1, -1])
    begin(cells, [0.3, 0.2, 0.4, 0.1, 0.2], [0, 0, 1, 1, -1])
    commit(cells, [0.01, 0.0, -0.01, 0.0, 0.0], np.array([True, False]))
    other.restore({name: saved.values for name, saved in cells.saved().items()})
    assert (other.demand, other.fed, other.void) == (cells.demand, cells.fed, cells.void)
    for each in (cells, other):
        begin(each, [0.7, 0.5, 0.5, 0.7, 0.7], [-1, 0, 1, -1, -1])
        commit(each, 0.002, np.array([True, True]))
    for name, saved in cells.saved().items():
        np.testing.assert_array_equal(other.saved()[name].values, saved.values, err_msg=name)
    assert (other.demand, other.fed, other.void) == (cells.demand, cells.fed, cells.void)


@pytest.mark.ranks
def test_a_rank_without_cells_knows_the_pockets_of_others(comm) -> None:
    count = 5 if comm.rank == comm.size - 1 else 0
    numbering = Numbering("cells of casting", np.arange(count), 5, ("casting",))
    cells = Content(comm, numbering, VOLUMES[:count])
    zeros, all_liquid = np.zeros(count), np.ones(count, dtype=bool)
    cells.begin(throughout([0, 0, 1, 1, 1][:count]), all_liquid, zeros, zeros, zeros)
    np.testing.assert_allclose(cells.pockets, [3.0, 12.0])


@pytest.mark.serial
def test_what_freezes_before_the_cut_is_fed() -> None:
    """By hand: the first cell freezes round what is cut off in a step."""
    cells = content()
    begin(cells, [0.0] * 5, [-1] * 5)
    commit(cells)
    cut = CutOff(
        np.array([-1, 0, 0, -1, -1], dtype=np.int32), np.array([0.7, 0.7, 0.7, 0.0, 0.0]),
        np.array([2, 2, 2, -1, -1], dtype=np.int32), 3,
    )  # fmt: skip
    f, then = np.array([0.8, 0.4, 0.3, 0.2, 1.0]), np.array([0.5, 0.3, 0.2, 0.1, 0.1])
    shrunk, at_cut = (S * np.minimum(part, COHERENCY) for part in (f, then))
    gained = np.array([0.01, 0.0, 0.0, 0.02, 0.0])
    cells.begin(cut, f < COHERENCY, shrunk, at_cut, np.zeros(5), gained)
    commit(cells)
    lacking = VOLUMES[:3] @ (shrunk - at_cut)[:3]
    assert cells.void == pytest.approx(lacking, rel=1e-14)
    assert cells.fed == pytest.approx(VOLUMES @ shrunk - lacking, rel=1e-14)
    drawn = (shrunk - at_cut)[0] * VOLUMES[0] / 5.0  # what lacks round the pool, out of it
    np.testing.assert_allclose(cells.pores[1:3], (shrunk - at_cut)[1:3] + drawn, rtol=1e-13)
    # From then on all of it lacks.
    begin(cells, list(f + np.array([0.0, 0.1, 0.1, 0.0, 0.0])), [-1, 0, 0, -1, -1])
    commit(cells)
    assert cells.void == pytest.approx(lacking + S * 0.1 * 5.0, rel=1e-13)


@pytest.mark.serial
@pytest.mark.parametrize("moment", [0.0, 0.25, 0.9, 0.999])
@pytest.mark.parametrize("porous", [ONE, ~ONE], ids=["porous", "full"])
def test_a_cut_in_a_step_is_one_between_two_steps(moment: float, porous) -> None:
    """Liquid freezes and walls close in evenly: pools feel their walls from the cut on alone."""
    one, two = content(), content()
    for each in (one, two):
        begin(each, [0.0] * 5, [-1] * 5)
        commit(each)
    end = np.array([0.5, 0.4, 0.3, 0.2, 0.1])
    lacking = (1.0 - moment) * S * VOLUMES @ end
    # A full pool has moved its walls by what it lacks from the cut on, one with pores by less.
    moved = -(0.4 if porous else 1.0) * lacking / 15.0 / (1.0 - moment)
    start: FloatArray = np.full(5, moment * moved)
    theta: FloatArray = np.full(5, moved)
    begin(two, list(moment * end), [-1] * 5)
    two.commit(start, porous[:0])
    shrunk, zeros = S * end, np.zeros(5, dtype=np.int32)
    cuts = CutOff(zeros, np.full(5, moment), zeros, 1), throughout([0] * 5)
    full: FloatArray = np.zeros(5)
    for each, cut, before in zip((one, two), cuts, (full, start), strict=True):
        each.begin(cut, np.ones(5, dtype=bool), shrunk, moment * shrunk, before)
        assert (each.void_fraction(theta) > 1e-9) == porous
        each.commit(theta, porous)
    assert one.void == pytest.approx(0.6 * lacking if porous else 0.0, rel=1e-9)
    assert (one.demand, one.fed, one.void) == pytest.approx((two.demand, two.fed, two.void))
    for name in ("content", "pores"):
        found, expected = (each.saved()[name].values for each in (one, two))
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-14, err_msg=name)


@pytest.mark.serial
def test_what_is_cut_off_and_freezes_in_one_step_keeps_its_pores() -> None:
    cells = content()
    begin(cells, [0.0] * 5, [-1] * 5)
    commit(cells)
    cut = CutOff(
        np.full(5, -1, dtype=np.int32), np.array([0.0, 0.0, 0.6, 0.6, 0.0]),
        np.array([-1, -1, 0, 0, -1], dtype=np.int32), 1,
    )  # fmt: skip
    end, at_cut = np.full(5, S * COHERENCY), np.full(5, S * 0.36)
    cells.begin(cut, np.zeros(5, dtype=bool), end, at_cut, np.zeros(5))
    commit(cells)
    np.testing.assert_allclose(cells.pores, [0.0, 0.0, 0.024, 0.024, 0.0], rtol=1e-14, atol=1e-16)
    assert cells.demand == pytest.approx(cells.fed + cells.void, rel=1e-14)
