"""Exact numbers of the record, which were found another way, and the run."""

import numpy as np
import pytest

from castx.proof.verification.coupled.chilled_alloy import linear_suction
from castx.proof.verification.foundry.feeding import (
    EUTECTIC_LIQUID,
    LIQUIDS,
    SCHEIL_LIQUIDS,
    VERIFICATION,
    scheil_suction,
    solidification_time,
)
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    exact = [0.264980, 4.524049, 16.87016, 30.87182, 50.12521, 87.10954]
    assert np.sqrt(linear_suction(np.array(LIQUIDS))) == pytest.approx(exact, rel=2e-6)
    assert pytest.approx(0.0912329, rel=1e-6) == EUTECTIC_LIQUID
    exact = [6.983703, 83.39936, 399.1399, 5558.827]
    assert scheil_suction(np.array(SCHEIL_LIQUIDS)) == pytest.approx(exact, rel=1e-6)
    assert solidification_time(0.01) == pytest.approx(238.9176, rel=1e-6)


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
