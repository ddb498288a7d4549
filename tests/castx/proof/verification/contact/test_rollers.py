import numpy as np
import pytest

from castx.proof.verification.contact.rollers import (
    HALF_WIDTH,
    LOAD,
    PEAK,
    VERIFICATION,
    exact_pressure,
)
from tests.castx.proof.verification.coarse_run import coarse_run


@pytest.mark.serial
def test_the_pressure_carries_the_load():
    x = HALF_WIDTH * np.sin(np.linspace(0.0, np.pi / 2, 2001))
    assert np.trapezoid(exact_pressure(x), x) == pytest.approx(LOAD / 2, rel=1e-6)
    assert exact_pressure(np.array([0.0, 2 * HALF_WIDTH])) == pytest.approx([PEAK, 0.0])


@pytest.mark.ranks
def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
