import numpy as np
import pytest

from castx.proof.verification.solids.manufactured import (
    VERIFICATION,
    exact_dilatation,
    exact_displacement,
)
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_dilatation_is_the_divergence(dimension):
    x = np.random.default_rng(5).uniform(0.1, 0.9, (dimension, 7))
    step, found = 1e-6, 0.0
    for k in range(dimension):
        shift = step * np.eye(dimension)[:, k, None]
        ends = [exact_displacement(x + sign * shift, dimension, np)[k] for sign in (1, -1)]
        found = found + (ends[0] - ends[1]) / (2 * step)
    np.testing.assert_allclose(exact_dilatation(x, dimension), found, atol=1e-8)


@pytest.mark.slow
def test_a_run(comm):
    coarse_run(VERIFICATION, comm, VERIFICATION.levels[-1])
