import numpy as np
import pytest

from castx.proof.verification.heat.radiation import TIMES, VERIFICATION, Lumps
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record_and_the_balance():
    lumps = Lumps()
    found = lumps.reference(TIMES)
    casting = [637.3752, 624.7570, 573.8996, 490.8956, 367.0859]
    assert found[:, 0] == pytest.approx(casting, abs=1e-4)
    mould = [220.9843, 225.7161, 244.7876, 275.9141, 322.3428]
    assert found[:, 1] == pytest.approx(mould, abs=1e-4)
    enthalpy = found @ lumps.capacities
    np.testing.assert_allclose(enthalpy, np.dot(lumps.temperatures, lumps.capacities), rtol=1e-9)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
