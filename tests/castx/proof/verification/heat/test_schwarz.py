import numpy as np
import pytest

from castx.proof.verification.heat.schwarz import VERIFICATION, Schwarz
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial

CASE = Schwarz()


def test_the_numbers_of_the_record():
    assert CASE.casting.front_number == pytest.approx(0.2949360318, abs=1e-10)
    assert CASE.interface == pytest.approx(597.6895, abs=1e-4)
    assert CASE.casting.front(1.0) == pytest.approx(5.151552e-3, rel=1e-6)
    places = np.array([-10e-3, -5e-3, 5e-3, 10e-3, 20e-3])
    exact = [383.991, 483.726, 617.317, 636.625, 661.623]
    assert CASE.temperature(places, 10.0) == pytest.approx(exact, abs=1e-3)


def test_the_mould_receives_what_the_casting_gives():
    assert CASE.mould_heat(7.0) == pytest.approx(CASE.casting.wall_heat(7.0), rel=1e-12)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
