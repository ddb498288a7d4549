"""Heat condition `convection`: means over a step, coefficients over temperature."""

from __future__ import annotations

import numpy as np
import pytest

from tests.heat_conditions import flux_law

pytestmark = pytest.mark.serial

TABLE = [[0, 10], [400, 90], [900, 20]]


def test_means_over_a_step():
    """From 2 to 6 s the means are those at 4 s."""
    law = flux_law("convection", coefficient=[[0, 50], [10, 90]], ambient=[[0, 20], [10, 40]])
    T = np.array([100.0, 900.0])
    flux, slope = law(2.0, 6.0, T)
    assert flux == pytest.approx(66.0 * (28.0 - T))
    assert slope == pytest.approx([-66.0, -66.0])


@pytest.mark.parametrize("of, h", [("film", 40.0), ("surface", 70.0)])
def test_a_coefficient_over_the_temperature_of_film_or_surface(of, h):
    """At 300 °C above 0 °C the film has 150 °C."""
    varying = {"over": "temperature", "table": TABLE, "of": of}
    law = flux_law("convection", coefficient=varying, ambient=0.0)
    assert law(0.0, 1.0, np.array([300.0]))[0] == pytest.approx([-h * 300.0])


@pytest.mark.parametrize("of", ["film", "surface"])
def test_slopes_by_differences(of):
    varying = {"over": "temperature", "table": TABLE, "of": of}
    law = flux_law("convection", coefficient=varying, ambient=50.0)
    T, step = np.array([80.0, 300.0, 650.0, 1300.0]), 1e-3
    rise = (law(2.0, 6.0, T + step)[0] - law(2.0, 6.0, T - step)[0]) / (2 * step)
    np.testing.assert_allclose(law(2.0, 6.0, T)[1], rise, rtol=1e-6, atol=1e-9)
