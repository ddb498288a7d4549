"""Directions that samples do not see: of sums, of one sample, of correlated priors."""

import numpy as np
import pytest

from castx.foundry.identification.directions import unseen

pytestmark = pytest.mark.serial


def test_a_sum_hides_the_difference():
    """Ten samples of a + b: the difference is unseen, c is seen by itself."""
    changes = np.vstack([np.tile([1.0, 1.0, 0.0], (10, 1)), [[0.0, 0.0, 5.0]]])
    (found,) = unseen(changes, np.array(1.0), np.eye(3), ["a", "b", "c"])
    assert found.singular_value == pytest.approx(0.0, abs=1e-12)
    assert set(found.names) == {"a", "b"}
    np.testing.assert_allclose(np.abs(found.parts), [np.sqrt(0.5), np.sqrt(0.5), 0.0], atol=1e-12)


def test_fewer_samples_than_parameters():
    found = unseen(np.array([[3.0, 0.0, 0.0]]), np.array(1.0), np.eye(3), ["a", "b", "c"])
    assert [direction.singular_value for direction in found] == [0.0, 0.0]
    assert {name for direction in found for name in direction.names} == {"b", "c"}


def test_the_prior_and_the_noise_decide():
    """Samples of a with slope 2: seen while 2 σ_a/σ is at least 1."""
    changes = np.array([[2.0, 0.0], [0.0, 9.0]])
    for deviation, noise, seen in ((1.0, 1.0, True), (0.4, 1.0, False), (1.0, 2.5, False)):
        prior = np.diag([deviation**2, 1.0])
        found = unseen(changes, np.array(noise), prior, ["a", "b"])
        assert len(found) == (0 if seen else 1)
        if not seen:
            assert found[0].names == ("a",)
            assert found[0].singular_value == pytest.approx(2.0 * deviation / noise)


def test_a_correlated_prior():
    """Singular values are the roots of the eigenvalues of Γ Jᵀ W J, whatever the root of Γ."""
    random = np.random.default_rng(3)
    changes, mixed = 0.3 * random.normal(size=(6, 4)), random.normal(size=(4, 4))
    prior = mixed @ mixed.T
    expected = np.sqrt(np.sort(np.linalg.eigvals(prior @ changes.T @ changes).real))
    found = [d.singular_value for d in unseen(changes, np.array(1.0), prior, list("abcd"))]
    np.testing.assert_allclose(found, expected[expected < 1.0], rtol=1e-7)
    assert found == sorted(found) and 0 < len(found) < 4
