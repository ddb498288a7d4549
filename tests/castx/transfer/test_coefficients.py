"""Numbers of the laws: resistances of rough and coated surfaces, what pressure adds."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.transfer.coefficients import SMALLEST_RELATIVE_PRESSURE
from tests.castx.transfer.law_samples import LIMITED, PRESSURE, ROUGH, coefficient

pytestmark = pytest.mark.serial


def test_roughness_and_coating():
    # R_z = ½√(30² + 40²) = 25 µm: R = 25e-6/0.04 + 100e-6/0.5 = 6.25e-4 + 2e-4 = 8.25e-4
    assert coefficient(ROUGH) == pytest.approx(1 / 8.25e-4, rel=1e-12)
    assert coefficient(ROUGH, 40e-6) == pytest.approx(1 / (8.25e-4 + 1e-3), rel=1e-12)
    beside = {**ROUGH, "pressure": {"hardness": 1e9, "exponent": 1.0}}
    assert coefficient(beside, 0.0, 1e8) == pytest.approx(1.1 / 8.25e-4, rel=1e-12)
    given = {**beside, "closed": 900}
    assert coefficient(given, 0.0, 1e8) == pytest.approx(900 + 0.1 / 8.25e-4, rel=1e-12)
    inside = {**LIMITED, "pressure": {**beside["pressure"], "roughness": [30e-6, 40e-6]}}
    assert coefficient(inside, 0.0, 1e8) == pytest.approx(800 + 0.1 / 6.25e-4, rel=1e-12)


@pytest.mark.parametrize("exponent", [0.5, 0.95])
def test_the_slope_over_pressure_is_bounded(exponent):
    heat = InterfaceHeat.read({**LIMITED, "pressure": {**PRESSURE, "exponent": exponent}})
    power = heat.conduction_law().pressure.power
    knee = SMALLEST_RELATIVE_PRESSURE * 1.2e9
    p = np.geomspace(1e-12, 1e9, 500)
    steepest = power(np.array([knee])) / knee
    assert (np.diff(power(p)) / np.diff(p) <= steepest * (1 + 1e-9)).all()
    np.testing.assert_allclose(power(np.array([knee, 2 * knee])), [1e-6**exponent, 2e-6**exponent])


@pytest.mark.parametrize("key, other", [("resistance", 2e-5), ("hardness", 2e9), ("exponent", 0.8)])
def test_every_number_of_the_pressure_law_acts(key, other):
    changed = {**LIMITED, "pressure": {**PRESSURE, key: other}}
    before = coefficient({**LIMITED, "pressure": PRESSURE}, 0.0, 1e8)
    assert abs(coefficient(changed, 0.0, 1e8) - before) > 1.0


@pytest.mark.parametrize("exponent", [0.6, 0.95, 1.0])
def test_rounded_the_slope_over_pressure_is_continuous_and_begins_with_zero(exponent):
    given = {**LIMITED, "transition": 1e-5, "pressure": {**PRESSURE, "exponent": exponent}}
    power = InterfaceHeat.read(given).conduction_law().pressure.power
    knee = SMALLEST_RELATIVE_PRESSURE * 1.2e9
    below, at, above = power(knee * np.array([1 - 1e-6, 1.0, 1 + 1e-6]))
    assert at - below == pytest.approx(above - at, rel=1e-4)
    assert power(np.array([1e-6 * knee]))[0] < 1e-5 * 1e-6 * at
