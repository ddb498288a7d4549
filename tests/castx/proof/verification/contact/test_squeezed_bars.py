import pytest

from castx.proof.verification.contact.squeezed_bars import VERIFICATION, pressure
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_number_of_the_record():
    assert pressure() == pytest.approx(12.727273e6, rel=1e-7)
    assert pressure(1e12) < pressure(1e13) < pressure()


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
