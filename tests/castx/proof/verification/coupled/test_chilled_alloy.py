import numpy as np
import pytest

from castx.proof.verification.coupled.chilled_alloy import (
    VERIFICATION,
    ChilledAlloy,
    critical_liquid,
)
from tests.castx.proof.verification.coarse_run import coarse_run

ALLOY = ChilledAlloy()
PLACES = np.array([5e-3, 10e-3, 20e-3])


@pytest.mark.serial
def test_the_numbers_of_the_record():
    exact = [84.34513, 133.8896, 212.5364]
    assert ALLOY.dimensionless_niyama(PLACES) == pytest.approx(exact, rel=1e-6)
    exact = [6.219406e-6, 9.872691e-6, 15.67192e-6]
    assert ALLOY.arm_spacing(PLACES) == pytest.approx(exact, rel=1e-6)
    exact = [1.24481e-3, 5.39751e-4, 2.24436e-4]
    assert ALLOY.pore_fraction(PLACES) == pytest.approx(exact, rel=1e-5)
    assert ALLOY.clyne_davies == pytest.approx(0.196217, rel=1e-5)
    assert ALLOY.freezing == pytest.approx(8545.79, rel=1e-6)


@pytest.mark.serial
def test_the_critical_liquid_of_known_values():
    known = {0.9: 0.264980, 0.5: 4.524049, 0.2: 16.87016, 0.1: 30.87182, 0.02: 87.10954}
    found = [critical_liquid(niyama) for niyama in known.values()]
    assert found == pytest.approx(list(known), rel=1e-5)


@pytest.mark.ranks
def test_a_run(comm):
    coarse_run(VERIFICATION, comm, VERIFICATION.levels[-1])
