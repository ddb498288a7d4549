"""Exact numbers of the record, which were found another way, and the run."""

import numpy as np
import pytest

from castx.proof.verification.foundry.mush_flow import (
    CUT,
    FREEZING,
    RATE,
    TIMES,
    VERIFICATION,
    coefficient,
    column,
    images,
    opening,
)
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    ("freezing", "stretching", "exact"),
    [
        (FREEZING, 0.0, [910.5686, 1429.1846]), (0.0, RATE, [803.0116, 1260.9495]),
        (FREEZING, RATE, [1713.5802, 2690.1342]),
    ],
)  # fmt: skip
def test_suction_of_the_record(freezing, stretching, exact):
    found = column(np.array([CUT, 0.0]), freezing, stretching)
    assert found == pytest.approx(exact, rel=1e-7)


def test_pores_and_load_of_the_record():
    found = [opening(pull) for pull in (100.0, 300.0)]
    assert found == pytest.approx([0.0578846, 0.0258256], rel=2e-6)
    assert coefficient() == pytest.approx(2.286237e-5, rel=1e-6)
    settlement, base = images(np.array(TIMES))
    assert settlement == pytest.approx([26.76176e-6, 57.29627e-6, 69.84448e-6], rel=1e-6)
    assert base == pytest.approx([9493.054, 3707.774, 1079.770], rel=1e-6)


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
