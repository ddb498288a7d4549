import pytest

from castx.proof.verification.contact.closed_mould import (
    HEIGHT,
    SHRINKAGE,
    VERIFICATION,
    WEIGHT,
    WIDTH,
)
from tests.castx.proof.verification.coarse_run import coarse_run


@pytest.mark.serial
def test_reference_numbers():
    assert WEIGHT == pytest.approx(141.264, rel=1e-12)
    assert (SHRINKAGE * HEIGHT, SHRINKAGE * WIDTH) == pytest.approx((0.72e-3, 1.2e-3))


@pytest.mark.ranks
def test_a_run(comm):
    coarse_run(VERIFICATION, comm)
