"""Exact numbers of the record, which were found another way, and the run."""

import numpy as np
import pytest

from castx.proof.verification.foundry.cold_part import (
    CONTRACTION,
    FRAMES,
    VERIFICATION,
    frame,
    sphere,
)
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    assert frame(FRAMES[0]) == pytest.approx([67.2e6, -134.4e6], rel=1e-12)
    left = [-0.05 * CONTRACTION, -(CONTRACTION**2), -(CONTRACTION**3)]
    assert left == pytest.approx([-0.684675e-3, -1.87512e-4, -2.56769e-6], rel=3e-6)


def test_the_sphere_is_round_and_in_balance():
    points = sphere(50)
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(points.sum(axis=0), 0.0, atol=1e-12)


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
