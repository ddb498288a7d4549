import pytest

from castx.proof.verification.heat.plates import VERIFICATION, Plates
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    plates = Plates()
    assert plates.flux == pytest.approx(5369.13, abs=5e-3)
    assert plates.walls == pytest.approx((233.557, 166.443), abs=5e-4)
    assert plates.exchange * (plates.walls[0] - plates.walls[1]) == pytest.approx(plates.flux)


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
