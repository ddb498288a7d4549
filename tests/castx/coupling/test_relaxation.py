"""Aitken's relaxation of the passes: what alternates contracts, stays positive, on all ranks."""

from mpi4py import MPI

import numpy as np
import pytest

from castx.coupling.relaxation import LEAST_SHARE, Relaxation


def iterate(comm, map_, start, passes: int, relaxed: bool = True):
    """Return the iterates of x = map(x)."""
    relaxation, iterates = Relaxation(comm), [np.asarray(start, dtype=float)]
    for _ in range(passes):
        found = map_(iterates[-1])
        iterates.append(relaxation.next(iterates[-1], found) if relaxed else found)
    return iterates


def test_first_iterate_is_plain(comm):
    assert Relaxation(comm).next(np.array([1.0]), np.array([1.2])) == pytest.approx([1.2])


@pytest.mark.ranks
@pytest.mark.parametrize("slope", [-0.2, -0.9, -1.0, -1.5, 0.3])
def test_one_unknown_with_a_linear_map_takes_three_passes(comm, slope):
    """Aitken's factor is the secant: exact for a linear map, also where the plain one diverges."""
    iterates = iterate(comm, lambda x: 5.0 + slope * (x - 5.0), np.full(3, 6.0), 2)
    assert iterates[2] == pytest.approx(5.0, rel=1e-12)


def test_two_cycle_of_a_kinked_map_converges(comm):
    """R = max(R0, g/k) with the gap falling as R grows: the plain iteration runs round for ever."""

    def passes(x):
        return np.maximum(1.0, 3.0 - 1.1 * x * np.array([1.0, 0.9]))

    fixed = np.array([3.0 / 2.1, 3.0 / 1.99])
    plain = iterate(comm, passes, [1.0, 1.0], 40, relaxed=False)
    assert np.abs(plain[-1] - fixed).max() > 0.1
    relaxed = iterate(comm, passes, [1.0, 1.0], 15)
    assert relaxed[-1] == pytest.approx(fixed, rel=1e-4)


def test_a_residual_that_grows_is_followed(comm):
    """A gap that grows the faster the wider it is, up to a bound: its state lies ahead."""

    def passes(x):
        return np.where(x < 2.0, 1.1 * x + 0.1, 2.3 + 0.2 * (x - 2.0))

    fixed = (2.3 - 0.4) / 0.8
    iterates = iterate(comm, passes, [1.0], 12)
    assert iterates[-1] == pytest.approx(fixed, rel=1e-6)


def test_iterates_stay_positive(comm):
    """A resistance that jumps down to a tiny one must not be extrapolated below zero."""
    relaxation = Relaxation(comm)
    tried = np.array([1.0, 1.0])
    found = np.array([1e-3, 0.9])
    for _ in range(10):
        tried = relaxation.next(tried, found)
        assert (tried > 0).all()
        assert (tried >= LEAST_SHARE * np.minimum(tried, found)).all()
        found = np.array([1e-6 / tried[0], 0.9])


@pytest.mark.ranks
def test_infinite_resistances_pass_through(comm):
    relaxation = Relaxation(comm)
    for found in ([np.inf, 2.0], [np.inf, 1.8], [3.0, 1.9]):
        given = relaxation.next(np.array([np.inf, 1.0]), np.array(found))
        assert given[0] == found[0]
        assert np.isfinite(given[1])


@pytest.mark.ranks
def test_equal_iterates_are_harmless(comm):
    iterates = iterate(comm, lambda x: x, np.array([1.0, 2.0]), 4)
    assert iterates[-1] == pytest.approx([1.0, 2.0])


@pytest.mark.ranks
def test_factor_is_one_for_all_ranks(comm):
    """Each rank holds other pairs: the product runs over all, so the iterates are those of one."""
    rng = np.random.default_rng(1)
    slopes = rng.uniform(-1.2, 0.0, size=6)
    alone = iterate(MPI.COMM_SELF, lambda x: 1.0 + slopes * x, np.ones(6), 6)[-1]
    own = slice(comm.rank * 6 // comm.size, (comm.rank + 1) * 6 // comm.size)
    spread = iterate(comm, lambda x: 1.0 + slopes[own] * x, np.ones(own.stop - own.start), 6)[-1]
    spread = np.concatenate(comm.allgather(spread))
    assert spread == pytest.approx(alone, rel=1e-12)


@pytest.mark.serial
@pytest.mark.parametrize(
    ("residuals", "factor"), [((0.2, 0.19), 1.5), ((0.2, 0.25), 1.0), ((0.2, -20.0), 0.05)]
)
def test_the_factor_stays_within_its_bounds(comm, residuals, factor):
    """Aitken's would be 20, -4 and 0.0099; a negative one would go back from a state that lies ahead."""
    relaxation, tried = Relaxation(comm), np.array([100.0])
    for residual in residuals:
        before, tried = tried, relaxation.next(tried, tried + residual)
    assert tried - before == pytest.approx(factor * residuals[-1], rel=1e-9)
