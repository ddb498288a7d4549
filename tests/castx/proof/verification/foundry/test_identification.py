"""Exact numbers of the record, which were found another way, and the run."""

import numpy as np
import pytest

from castx.proof.verification.foundry.identification import VERIFICATION, by_one, sums, uncertainty
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    exact = [8.651467e-4, 1.417963e-3, 0.3420057, 0.7922983]
    assert uncertainty() == pytest.approx(exact, rel=1e-6)
    assert by_one(np.array(52.0)) == pytest.approx(5.436564e-3, rel=1e-6)


def test_the_sums_are_those_of_their_terms():
    k, q = np.arange(1.0, 61.0), np.exp(-1000.0 / 2.6e4)
    assert sums() == pytest.approx([(k**n * q**k).sum() for n in range(3)], rel=1e-10)


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
