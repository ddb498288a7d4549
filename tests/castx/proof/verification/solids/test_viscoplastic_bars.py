import pytest

from castx.proof.verification.solids.viscoplastic_bars import (
    VERIFICATION,
    exact_maxwell,
    exact_norton,
)
from castx.proof.verification.verification import Resolution
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    values = [exact_maxwell(t) for t in (1.0, 5.0, 20.0, 100.0)]
    assert values == pytest.approx([2.302721e6, 9.813870e6, 23.360383e6, 28.793077e6], rel=1e-6)
    values = [exact_norton(t) for t in (10.0, 100.0, 1000.0)]
    assert values == pytest.approx([8.034080e6, 4.517999e6, 2.540663e6], rel=1e-6)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm, Resolution(0.01, 1 / 25))
