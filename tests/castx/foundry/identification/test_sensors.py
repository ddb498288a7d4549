"""Choice of sensors: depths left out exactly, the best of few by trial, and what each rule asks."""

from itertools import combinations

import numpy as np
import pytest

from castx.foundry.identification.covariance import posterior
from castx.foundry.identification.sensors import Candidate, a_optimal, d_optimal

pytestmark = pytest.mark.serial

RANDOM = np.random.default_rng(11)


def candidate(name, size=1.0, depth_deviation=3e-4):
    return Candidate(
        name,
        size * RANDOM.normal(size=(8, 3)),
        3000.0 * RANDOM.normal(size=8),
        np.array(0.5),
        depth_deviation,
    )


def test_an_unknown_depth_is_fitted_beside_the_parameters():
    """What is left is the block of the parameters in the covariance of all."""
    place = candidate("one")
    both = np.column_stack([place.sensitivity, place.by_depth])
    prior = np.diag([1.0, 2.0, 3.0, place.depth_deviation**2])
    whole = posterior(both, place.noise, prior)[:3, :3]
    left = np.linalg.inv(place.information() + np.linalg.inv(prior[:3, :3]))
    np.testing.assert_allclose(left, whole, rtol=1e-10)


def test_a_known_depth_tells_all():
    known, guessed = (
        Candidate("one", np.ones((4, 1)), np.ones(4), np.array(1.0), deviation)
        for deviation in (0.0, 1.0)
    )
    assert known.information()[0, 0] == pytest.approx(4.0)
    assert guessed.information()[0, 0] == pytest.approx(4.0 - 16.0 / 5.0)


def test_the_first_choice_is_the_best_and_the_pair_nearly():
    places = [candidate(str(k), size) for k, size in enumerate((1.0, 0.2, 2.0, 0.7, 1.5))]
    prior = 4.0 * np.eye(3)

    def determinant(names):
        told = sum(p.information() for p in places if p.name in names) + np.linalg.inv(prior)
        return np.linalg.slogdet(told)[1]

    first, second = d_optimal(places, 2, prior)
    assert first == max("01234", key=lambda name: determinant([name]))
    best = max(determinant(pair) for pair in combinations("01234", 2))
    nothing = determinant([])
    assert first != second
    assert determinant([first, second]) - nothing > (1.0 - np.exp(-1.0)) * (best - nothing)


def test_wanted_parameters_decide():
    """One place tells the first parameter, one the second: each is taken for what is wanted."""
    def one(name, column):
        changes = np.zeros((5, 2))
        changes[:, column] = 1.0 + column
        return Candidate(name, changes, np.zeros(5), np.array(1.0))

    places = [one("a", 0), one("b", 1)]
    assert a_optimal(places, 1, np.eye(2), [0]) == ("a",)
    assert a_optimal(places, 1, np.eye(2), [1]) == ("b",)
    assert a_optimal(places, 2, np.eye(2), [0, 1]) == ("b", "a") == d_optimal(places, 2, np.eye(2))


def test_a_place_whose_depth_blurs_what_it_tells_comes_last():
    """Both tell the same, one with a depth that changes it as the parameter does."""
    changes = np.ones((6, 1))
    blurred = Candidate("blurred", changes, 1e5 * np.ones(6), np.array(1.0))
    clear = Candidate("clear", changes, np.zeros(6), np.array(1.0))
    assert d_optimal([blurred, clear], 1, np.eye(1)) == ("clear",)
    assert a_optimal([blurred, clear], 1, np.eye(1), [0]) == ("clear",)


def test_more_sensors_than_places_are_refused():
    with pytest.raises(ValueError, match="2 sensors are wanted of 1"):
        d_optimal([candidate("one")], 2, np.eye(3))
