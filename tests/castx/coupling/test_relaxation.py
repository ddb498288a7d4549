"""Aitken's relaxation of the passes: what alternates contracts and stays positive."""

from mpi4py import MPI

import numpy as np
import pytest

from castx.coupling.relaxation import ALONE, LEAST_SHARE, Relaxation, goes_round


def new() -> Relaxation:
    """Return the relaxation of pairs that are all on this rank."""
    return Relaxation(MPI.COMM_SELF)


def iterate(map_, start, passes: int, relaxed: bool = True):
    """Return the iterates of x = map(x)."""
    relaxation, iterates = new(), [np.asarray(start, dtype=float)]
    for _ in range(passes):
        found = map_(iterates[-1])
        iterates.append(relaxation.next(iterates[-1], found) if relaxed else found)
    return iterates


def test_first_iterate_is_plain():
    assert new().next(np.array([1.0]), np.array([1.2])) == pytest.approx([1.2])


@pytest.mark.parametrize("slope", [-0.2, -0.9, -1.0, -1.5, 0.3])
def test_one_unknown_with_a_linear_map_takes_three_passes(slope):
    """Aitken's factor is the secant: exact for a linear map, also where the plain one diverges."""
    iterates = iterate(lambda x: 5.0 + slope * (x - 5.0), np.full(3, 6.0), 2)
    assert iterates[2] == pytest.approx(5.0, rel=1e-12)


def test_two_cycle_of_a_kinked_map_converges():
    """R = max(R0, g/k) with the gap falling as R grows: the plain iteration runs round for ever."""

    def passes(x):
        return np.maximum(1.0, 3.0 - 1.1 * x * np.array([1.0, 0.9]))

    fixed = np.array([3.0 / 2.1, 3.0 / 1.99])
    plain = iterate(passes, [1.0, 1.0], 40, relaxed=False)
    assert np.abs(plain[-1] - fixed).max() > 0.1
    relaxed = iterate(passes, [1.0, 1.0], 15)
    assert relaxed[-1] == pytest.approx(fixed, rel=1e-4)


def test_a_residual_that_grows_is_followed():
    """A gap that grows the faster the wider it is, up to a bound: its state lies ahead."""

    def passes(x):
        return np.where(x < 2.0, 1.1 * x + 0.1, 2.3 + 0.2 * (x - 2.0))

    fixed = (2.3 - 0.4) / 0.8
    iterates = iterate(passes, [1.0], 12)
    assert iterates[-1] == pytest.approx(fixed, rel=1e-6)


def test_iterates_stay_positive():
    """A resistance that jumps down to a tiny one must not be extrapolated below zero."""
    relaxation = new()
    tried = np.array([1.0, 1.0])
    found = np.array([1e-3, 0.9])
    for _ in range(10):
        tried = relaxation.next(tried, found)
        assert (tried > 0).all()
        assert (tried >= LEAST_SHARE * np.minimum(tried, found)).all()
        found = np.array([1e-6 / tried[0], 0.9])


def test_infinite_resistances_pass_through():
    relaxation = new()
    for found in ([np.inf, 2.0], [np.inf, 1.8], [3.0, 1.9]):
        given = relaxation.next(np.array([np.inf, 1.0]), np.array(found))
        assert given[0] == found[0]
        assert np.isfinite(given[1])


def test_equal_iterates_are_harmless():
    iterates = iterate(lambda x: x, np.array([1.0, 2.0]), 4)
    assert iterates[-1] == pytest.approx([1.0, 2.0])


def test_pairs_do_not_heed_each_other():
    """A factor that all share cannot be the secant of slopes that differ."""
    slopes = np.array([-1.6, -0.9, 0.0, 0.2])
    iterates = iterate(lambda x: 5.0 + slopes * (x - 5.0), np.array([6.0, 5.5, 5.2, 4.0]), 2)
    assert iterates[2] == pytest.approx(5.0, rel=1e-12)


def test_pairs_that_share_their_heat_converge():
    """A pair that opens heats the others too: slopes of a block, steeper than the plain map."""
    share = np.array([[-1.0, -0.2, -0.1], [-0.2, -0.9, -0.2], [-0.1, -0.2, -1.1]])
    start = np.array([6.0, 5.5, 4.8])
    assert iterate(lambda x: 5.0 + share @ (x - 5.0), start, 8)[-1] == pytest.approx(5.0, rel=1e-3)
    plain = iterate(lambda x: 5.0 + share @ (x - 5.0), start, 8, relaxed=False)
    assert np.abs(plain[-1] - 5.0).max() > 1.0


def test_pairs_that_hang_on_each_other_more_than_on_themselves_are_foreseen_together():
    """Secants of each alone, which is all that the first passes have, lead away from it."""
    share = np.array([[-0.5, -1.3, 0.4], [1.2, -0.3, -1.1], [-0.7, 0.9, -0.4]])

    def passes(x):
        return 5.0 * np.exp(share @ np.log(x / 5.0))

    iterates = iterate(passes, [5.6, 5.5, 4.7], ALONE + 4)
    assert np.abs(iterates[ALONE] - 5.0).max() > 0.5
    assert iterates[-1] == pytest.approx(5.0, rel=1e-9)


def test_pairs_that_are_foreseen_together_change_tenfold_at_most():
    """A residual that falls by a four-hundredth a pass would be followed by a factor of e^4."""
    relaxation, wanted = new(), np.zeros(1)
    for n in range(ALONE + 1):
        tried = np.exp([0.01 * n])
        found = tried * np.exp(0.2 - 5e-4 * n)
        wanted = relaxation.next(tried, found)
    assert wanted == pytest.approx(found / LEAST_SHARE, rel=1e-9)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("residuals", "factor"), [((0.2, 0.19), 1.5), ((0.2, 0.25), 1.0), ((0.2, -20.0), 0.05)]
)
def test_the_factor_stays_within_its_bounds(residuals, factor):
    """Aitken's would be 20, -4 and 0.0099; with a negative one the state lies ahead."""
    relaxation, tried = new(), np.array([100.0])
    for residual in residuals:
        before, tried = tried, relaxation.next(tried, tried + residual)
    assert tried - before == pytest.approx(factor * residuals[-1], rel=1e-9)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("changes", "round"),
    [
        ([0.85**n for n in range(40)], False),  # slow, but it will get there
        ([0.5, 0.2, 0.1, *[0.05, 0.02, 0.3] * 3], True),
        ([0.5, 0.2, 0.1, *[0.05, 0.02, 0.3] * 2], False),  # not yet
        ([0.01 + 0.5**n for n in range(20)], True),
        ([0.01, *[0.3] * 10, 0.004], False),
    ],
)
def test_passes_that_come_no_closer_are_given_up(changes, round):
    assert goes_round(changes) == round
