import pytest

from castx.proof.verification.contact.cut_cube import VERIFICATION, contact_pressure
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_number_of_the_record():
    assert contact_pressure(10.0) == pytest.approx(2.288e7, rel=1e-12)
    assert contact_pressure(-1.0) == 0.0


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
