"""The law that limits the coefficient of the gas layer by that of contact."""

from __future__ import annotations

import numpy as np
import pytest

from tests.castx.transfer.law_samples import (
    BY_GAP,
    BY_PRESSURE,
    GAS,
    LIMITED,
    PRESSURE,
    coefficient,
    conductance,
)

pytestmark = pytest.mark.serial


def test_limited_is_the_smaller_of_contact_and_gas():
    # 0.04/100e-6 = 400, 0.04/50e-6 = 800, 0.04/25e-6 = 1600
    h = coefficient(LIMITED, [0.0, 25e-6, 50e-6, 100e-6, 1e-3])
    np.testing.assert_allclose(h, [800.0, 800.0, 800.0, 400.0, 40.0], rtol=1e-12)


def test_closed_contact_of_two_bars():
    # verification V19: h0 + (1/R)(p/H_e)^b at p = 276.472197 MPa
    h = coefficient({**LIMITED, "pressure": PRESSURE}, 0.0, 276.472197e6)
    np.testing.assert_allclose(h, 15676.404, rtol=1e-6)


def test_gas_over_the_mean_temperature():
    heat = {**LIMITED, "gas_conductivity": GAS}
    k = 0.025 + 0.045 * 0.35  # at 350 °C
    assert coefficient(heat, 1e-3) == pytest.approx(k / 1e-3)


def test_open_over_the_gap():
    both = {"law": "limited", "closed": BY_PRESSURE, "open": BY_GAP}
    found = coefficient(both, [0.0, 0.0, 50e-6], [5e6, 0.0, 0.0])
    assert found == pytest.approx([2900.0, 800.0, 550.0])


def test_what_passes_where_surfaces_touch_and_what_the_gas_carries():
    np.testing.assert_array_equal(conductance(LIMITED, [0.0, 1e-6, -1e-6]).contact, [1.0, 0.0, 1.0])


def test_penetration_counts_as_closed_and_tension_as_no_pressure():
    heat = {**LIMITED, "pressure": PRESSURE}
    np.testing.assert_array_equal(coefficient(heat, -1e-6, -1e6), coefficient(heat, 0.0, 0.0))
