"""Bands of tables and of curves by propagated covariance."""

import numpy as np
import pytest

from castx.studies.inverse.identify import fitted
from castx.studies.inverse.model import MeasuredCase
from castx.studies.inverse.predictions import probe_bands, table_bands
from tests.castx.cooled_mould import TIME, temperature
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
    (one,) = probe_bands(model, model.unknowns(), found, ["near.temperature"])
    draws = np.random.default_rng(0).multivariate_normal(found.fitted, found.widened, 4000)
    curves = np.array(
        [temperature(np.exp(np.interp(TIME, [0.0, 10.0, 30.0], row)), 2e-3) for row in draws]
    )
    at = [10, 30, 60]
    half = (one.high - one.value)[at]
    np.testing.assert_allclose(half, 1.96 * curves.std(axis=0)[at], rtol=0.08)
    np.testing.assert_allclose(one.value[at], curves.mean(axis=0)[at], atol=0.1)
