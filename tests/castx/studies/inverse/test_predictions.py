"""Bands of tables and of curves by propagated covariance."""

import numpy as np
import pytest

from castx.studies.inverse.identify import fitted
from castx.studies.inverse.model import MeasuredCase
from castx.studies.inverse.predictions import curve_bands, table_bands
from tests.castx.cooled_mould import TIME, measured, temperature
from tests.castx.studies.inverse.measured_case import opened

pytestmark = pytest.mark.serial


@pytest.fixture(scope="module")
def fit_and_model(tmp_path_factory):
    unknown = {"over": "time", "knots": [0, 10, 30], "start": 1000}
    runner, study = opened(tmp_path_factory.mktemp("case"), unknown=unknown)
    model = MeasuredCase.of(runner, study)
    return fitted(model, study), model


def test_a_table_has_the_deviations_of_its_knots(fit_and_model):
    found, model = fit_and_model
    (one,) = table_bands(model.parameters.sought, found)
    for k, knot in enumerate((0.0, 10.0, 30.0)):
        at = int(np.flatnonzero(one.argument == knot)[0])
        half = 1.96 * np.sqrt(found.widened[k, k])
        assert np.log(one.high[at] / one.value[at]) == pytest.approx(half)
        assert np.log(one.value[at]) == pytest.approx(found.fitted[k])
    between = int(np.flatnonzero(one.argument == 5.0)[0])
    part = 0.25 * found.widened[:2, :2].sum()
    assert np.log(one.high[between] / one.value[between]) == pytest.approx(1.96 * np.sqrt(part))


def test_a_curve_has_the_spread_of_drawn_tables(fit_and_model):
    found, model = fit_and_model
    (one,) = curve_bands(model.sensors, found)
    assert one.name == "near.temperature" and one.abscissa == "time [s]"
    np.testing.assert_array_equal(one.argument, model.sensors.sensors[0].time)
    draws = np.random.default_rng(0).multivariate_normal(found.fitted, found.widened, 4000)
    curves = np.array(
        [temperature(np.exp(np.interp(TIME, [0.0, 10.0, 30.0], row)), 2e-3) for row in draws]
    )
    at = [10, 30, 60]
    half = (one.high - one.value)[at]
    np.testing.assert_allclose(half, 1.96 * curves.std(axis=0)[at], rtol=0.08)
    np.testing.assert_allclose(one.value[at], curves.mean(axis=0)[at], atol=0.1)


def test_a_curve_is_that_of_the_place_that_was_found(tmp_path):
    """Deeper by 0.25 mm than the case says, which is known to 0.3 mm: on the samples all the same.

    Its band holds what is not known of the depth: with h it is that of two numbers.
    """
    text = measured(1400.0, 2.25e-3, 0.1)
    runner, study = opened(tmp_path, text, depth=True, unknown={"deviation": 0.01, "start": 1400})
    model = MeasuredCase.of(runner, study)
    found = fitted(model, study)
    assert found.fitted[1] == pytest.approx(2.5e-4, abs=3e-5)
    (one,) = curve_bands(model.sensors, found)
    exact = temperature(np.full(len(TIME), 1400.0), 2.25e-3)[: len(one.value)]
    np.testing.assert_allclose(one.value, exact, atol=0.2)
    draws = np.random.default_rng(0).multivariate_normal(found.fitted, found.widened, 4000)
    curves = [temperature(np.full(len(TIME), np.exp(h)), 2e-3 + depth)[60] for h, depth in draws]
    assert (one.high - one.value)[60] == pytest.approx(1.96 * np.std(curves), rel=0.1)
