"""What samples of a cooling body tell of its surface, against exact values (specification, 3.5)."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from castx.foundry.identification.covariance import correlation, deviations
from castx.foundry.identification.lumped import LumpedCooling

pytestmark = pytest.mark.serial

BODY = LumpedCooling(2.6e4, 500.0, 600.0, 100.0)
TIME = np.arange(1.0, 61.0)


def test_the_sensitivity_is_the_derivative():
    step = 1e-5
    for column, changed in enumerate((
        [LumpedCooling(2.6e4, 500.0 * np.exp(s * step), 600.0, 100.0) for s in (1, -1)],
        [LumpedCooling(2.6e4, 500.0, 600.0 + s * step, 100.0) for s in (1, -1)],
    )):  # fmt: skip
        slope = (changed[0].temperature(TIME) - changed[1].temperature(TIME)) / (2 * step)
        np.testing.assert_allclose(BODY.sensitivity(TIME)[:, column], slope, rtol=1e-6)


def test_how_well_samples_of_one_minute_tell_the_coefficient():
    alone = deviations(BODY.covariance(TIME, 1.0))
    assert alone == pytest.approx([8.651467e-4], rel=1e-6)
    both = BODY.covariance(TIME, 1.0, start_known=False)
    assert deviations(both) == pytest.approx([1.417963e-3, 0.3420057], rel=1e-6)
    assert correlation(both)[0, 1] == pytest.approx(0.7922983, rel=1e-6)
    np.testing.assert_allclose(BODY.covariance(TIME, 2.0), 4.0 * alone[None] ** 2)


def test_the_best_time_of_one_sample():
    def deviation(time):
        return float(deviations(BODY.covariance(np.array([time]), 1.0))[0])

    assert BODY.best_time == pytest.approx(52.0, rel=1e-12)
    assert deviation(52.0) == pytest.approx(5.436564e-3, rel=1e-6)
    found = minimize_scalar(deviation, bounds=(5.0, 200.0), method="bounded")
    assert found.x == pytest.approx(52.0, rel=1e-4)
