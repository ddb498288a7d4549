import pytest

from castx.proof.verification.contact.wide_base import PENALTIES, VERIFICATION, reaction
from tests.castx.proof.verification.coarse_run import coarse_run


@pytest.mark.serial
def test_springs_in_series():
    """30 mm of 1000 MPa on 20 mm of 10000 MPa, 10 mm wide, pushed by 0.1 mm in plane strain."""
    assert reaction() == pytest.approx(1e-4 * 0.01 / (0.91 * 32e-12), rel=1e-12)
    found = [reaction(penalty) for penalty in PENALTIES]
    assert found == sorted(found) and found[-1] < reaction()


@pytest.mark.ranks
def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
