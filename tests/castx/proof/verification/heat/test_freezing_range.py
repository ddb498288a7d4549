import numpy as np
import pytest

from castx.proof.verification.heat.freezing_range import VERIFICATION, FreezingRange
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial

ALLOY = FreezingRange()


def test_the_numbers_of_the_record():
    assert ALLOY.flux == pytest.approx(6.668644e6, rel=1e-6)
    assert ALLOY.fronts == pytest.approx([7.527429e-3, 1.0481317e-2], rel=1e-6)
    places = np.array([2e-3, 4e-3, 6e-3, 10e-3])
    exact = [373.720, 445.228, 512.507, 611.442]
    assert ALLOY.temperature(places, 1.0) == pytest.approx(exact, abs=1e-3)
    assert abs(ALLOY.parts[2].y[1, -1]) < 1e-6 * ALLOY.flux


def test_the_niyama_value_is_that_of_gradient_and_cooling_rate():
    assert ALLOY.niyama() == pytest.approx(2740.71, rel=1e-5)
    x, t, dx, dt = 0.01, (0.01 / ALLOY.place_of(0.9)) ** 2, 1e-6, 1e-4
    near = ALLOY.temperature(np.array([x - dx, x, x + dx]), t)
    assert ALLOY.solid_fraction(near[1]) == pytest.approx(0.9, abs=1e-6)
    gradient = (near[2] - near[0]) / 2 / dx
    later, sooner = (ALLOY.temperature(np.array([x]), t + d)[0] for d in (dt, -dt))
    assert gradient / np.sqrt((sooner - later) / 2 / dt) == pytest.approx(ALLOY.niyama(), rel=1e-4)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
