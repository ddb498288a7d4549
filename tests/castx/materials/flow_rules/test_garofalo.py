"""Garofalo's flow rule: rate creep_rate sinh(q/breakdown_stress)^exponent, thermally activated."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.arrays import FloatArray
from castx.materials.flow import VISCOPLASTIC, solid_flow
from castx.materials.flow_rules.garofalo import overstress, rate_of_stress, stress_of_rate
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

GAS = 8.314462618


def rate(f: float, values: Mapping[str, float], temperature: float) -> float:
    arrhenius = np.exp(-values["activation_energy"] / (GAS * (temperature + 273.15)))
    sinh = np.sinh(min(f / values["breakdown_stress"], 100.0))  # a solver of rates may try more
    return float(values["creep_rate"] * sinh ** values["exponent"] * arrhenius)


def drawn(draw: st.DrawFn, stress: float, rate: float, temperature: float) -> dict[str, float]:
    exponent, energy = draw(st.floats(0.7, 8.0)), draw(st.floats(0.0, 3e5))
    scale = stress / draw(st.floats(0.1, 20.0))
    arrhenius = np.exp(-energy / (GAS * (temperature + 273.15)))
    coefficient = rate / np.sinh(stress / scale) ** exponent / arrhenius
    return {
        "creep_rate": coefficient,
        "breakdown_stress": scale,
        "exponent": exponent,
        "activation_energy": energy,
    }


def test_a_printed_value() -> None:
    """σ0 = 20 MPa, n = 2, A = 3/s, no barrier: 20 MPa creep at 3 sinh(1)² = 4.1433 /s."""
    values = {
        "creep_rate": np.array([3.0]), "breakdown_stress": np.array([20e6]),
        "exponent": np.array([2.0]), "activation_energy": np.array([0.0]),
    }  # fmt: skip
    found = overstress(values, np.array([400.0]), 0.5)
    assert found(np.array([0.5 * 4.143293536625]))[0] == pytest.approx(20e6, rel=1e-9)


@given(q=st.floats(1e5, 1e9), step=st.floats(1e-3, 1e3))
def test_tables_over_temperature(q: float, step: float) -> None:
    keys = {
        "creep_rate": [[0, 1e8], [400, 3e8]],
        "breakdown_stress": [[0, 4e7], [400, 2e7]],
        "exponent": [[0, 5.0], [400, 4.0]],
        "activation_energy": [[0, 1.2e5], [400, 1.6e5]],
    }
    modulus, temperature = np.array([20e9, 26e9]), np.array([100.0, 400.0])
    material = alloy(law="garofalo", **keys, yield_stress=5e7)
    properties = solid_flow(material, VISCOPLASTIC, modulus, temperature, step)
    scale, exponent = np.array([3.5e7, 2e7]), np.array([4.75, 4.0])
    log_rate = (
        np.log(np.array([1.5e8, 3e8]))
        + exponent * (q / scale + np.log1p(-np.exp(-2.0 * q / scale)) - np.log(2.0))
        - np.array([1.3e5, 1.6e5]) / (GAS * (temperature + 273.15))
    )
    assert properties.overstress is not None
    found, _ = properties.overstress.evaluate(log_rate + np.log(step))
    np.testing.assert_allclose(found, q, rtol=1e-9)
    assert not properties.yield_stress.any()


def test_small_stresses_creep_by_a_power_and_large_ones_exponentially() -> None:
    scale, exponent, reference = np.full(2, 2e7), np.full(2, 5.0), np.full(2, -3.0)
    small = rate_of_stress(np.array([2.0, 4.0]), scale, exponent, reference)
    assert small[1] - small[0] == pytest.approx(5.0 * np.log(2.0), rel=1e-9)
    large = rate_of_stress(np.array([2e10, 2e10 + 2e7]), scale, exponent, reference)
    assert large[1] - large[0] == pytest.approx(5.0, rel=1e-9)


def test_slope_and_inverse_over_all_rates() -> None:
    log_rate: FloatArray = 10.0 * np.arange(-300.0, 301.0)
    ones = np.ones_like(log_rate)
    parameters = (2e7 * ones, 4.0 * ones, -20.0 * ones)
    stress, slope = stress_of_rate(log_rate, *parameters)
    step = 1e-4
    above, below = (stress_of_rate(log_rate + s, *parameters)[0] for s in (step, -step))
    np.testing.assert_allclose((above - below) / (2.0 * step), slope, rtol=1e-5, atol=1e-300)
    known = stress > 1e-290
    back = rate_of_stress(stress[known], *(values[known] for values in parameters))
    np.testing.assert_allclose(back, log_rate[known], rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("temperature", [-273.15, -273.0, -200.0, 1e4])
def test_numbers_at_every_temperature(temperature: float) -> None:
    keys = {"creep_rate": 1e9, "breakdown_stress": 2.5e7, "exponent": 5, "activation_energy": 1.5e5}
    properties = solid_flow(
        alloy(law="garofalo", **keys), VISCOPLASTIC, np.ones(2), np.full(2, temperature), 1.0
    )
    stress = properties.overstress(np.ones(2))
    assert np.isfinite(stress).all() and (stress > 0.0).all()
