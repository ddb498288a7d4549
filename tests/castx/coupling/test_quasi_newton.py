"""Quasi-Newton steps of passes: exact for maps that are linear in logarithms."""

from mpi4py import MPI

import numpy as np
import pytest

from castx.coupling.quasi_newton import COLUMNS, QuasiNewton

FIXED = np.array([2e-4, 5e-5, 1e-3])
SHARES = np.array([[-0.5, -1.3, 0.4], [1.2, -0.3, -1.1], [-0.7, 0.9, -0.4]])
TRIED = FIXED * np.array([[2.0, 1.0, 1.0], [1.0, 0.5, 1.1], [1.3, 1.0, 3.0], [0.9, 1.1, 1.0]])
FOUND = FIXED * np.exp(np.log(TRIED / FIXED) @ SHARES.T)


def after(tried, found, comm=MPI.COMM_SELF) -> QuasiNewton:
    """Return the steps behind some passes."""
    steps = QuasiNewton(comm)
    for before, behind in zip(tried, found, strict=True):
        steps.add(before, behind)
    return steps


def test_as_many_passes_as_pairs_and_one_more_tell_a_linear_map():
    assert len(TRIED) == COLUMNS + 1
    assert after(TRIED, FOUND).wanted() == pytest.approx(FIXED, rel=1e-9)


def test_what_is_known_of_fewer_passes_makes_the_residual_least():
    """Two passes tell one direction: no other part of it leaves a smaller residual."""
    wanted = after(TRIED[2:], FOUND[2:]).wanted()
    change = np.log(TRIED[2] / TRIED[3])
    residual, along = np.log(FOUND[3] / TRIED[3]), (SHARES - np.eye(3)) @ change
    share = -(along @ residual) / (along @ along)
    expected = np.log(FOUND[3]) + share * np.log(FOUND[2] / FOUND[3])
    assert np.log(wanted) == pytest.approx(expected, rel=1e-9)


def test_a_single_pass_and_equal_ones_are_followed_as_they_are():
    assert after(TRIED[:1], FOUND[:1]).wanted() == pytest.approx(FOUND[0], rel=1e-12)
    assert after(TRIED[[0, 0]], FOUND[[0, 0]]).wanted() == pytest.approx(FOUND[0], rel=1e-12)


def test_passes_farther_back_are_forgotten():
    tried, found = np.array([[1.0, 7.0, 1e-3], *TRIED]), np.array([[9.0, 1e-3, 1.0], *FOUND])
    assert after(tried, found).wanted() == pytest.approx(FIXED, rel=1e-9)


@pytest.mark.filterwarnings("error")
def test_a_residual_that_hardly_falls_leads_far_away_without_a_warning():
    """By e^{1000} and e^{-1000}."""
    tried = np.exp([[0.0, 0.0], [1.0, -1.0]])
    found = np.exp([[1.001, -1.001], [2.0, -2.0]])
    assert after(tried, found).wanted() == pytest.approx([np.inf, 0.0])


@pytest.mark.parametrize("dead", [0.0, np.inf])
def test_pairs_that_did_not_conduct_say_nothing_of_the_others(dead):
    column = np.full((len(TRIED), 1), 3.0)
    column[1] = dead
    found = after(np.hstack([TRIED, column]), np.hstack([FOUND, column + 1.0])).wanted()
    assert found[:3] == pytest.approx(FIXED, rel=1e-9)
    assert np.isfinite(found).all()


@pytest.mark.ranks
def test_ranks_share_their_pairs(comm):
    """All of them or the first one."""
    for ranks in (comm.size, 1):
        own = np.arange(3) % ranks == comm.rank
        found = after(TRIED[:, own], FOUND[:, own], comm).wanted()
        assert found == pytest.approx(FIXED[own], rel=1e-9)
