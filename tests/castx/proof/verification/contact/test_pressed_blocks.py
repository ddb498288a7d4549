import pytest

from castx.proof.verification.contact.pressed_blocks import SETTLING, VERIFICATION
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_number_of_the_record():
    assert pytest.approx(-6.365e-5, rel=1e-12) == SETTLING


def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
