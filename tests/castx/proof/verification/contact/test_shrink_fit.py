import numpy as np
import pytest

from castx.proof.verification.contact.shrink_fit import VERIFICATION, ShrinkFit
from tests.castx.proof.verification.coarse_run import coarse_run

FIT = ShrinkFit()


@pytest.mark.serial
def test_the_numbers_of_the_record():
    assert FIT.pressure == pytest.approx(42.960516e6, rel=1e-7)
    assert FIT.pressure * FIT.ratio == pytest.approx(71.600860e6, rel=1e-7)
    assert FIT.hoop_stress(np.array([FIT.inner])) == pytest.approx(71.600860e6, rel=1e-7)


@pytest.mark.serial
def test_the_hub_bears_the_pressure():
    r = np.linspace(FIT.inner, FIT.outer, 10001)
    pulled = np.trapezoid(FIT.hoop_stress(r), r)
    assert pulled == pytest.approx(FIT.pressure * FIT.inner, rel=1e-6)


@pytest.mark.ranks
def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
