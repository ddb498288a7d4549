"""Norton's flow rule: rate coefficient q^exponent exp(−activation_energy/(R T_K))."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.materials.flow import VISCOPLASTIC, liquid_flow, solid_flow
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

GAS = 8.314462618
MODULUS, TEMPERATURE = np.array([20e9, 26e9]), np.array([100.0, 400.0])


def rate(f: float, values: Mapping[str, float], temperature: float) -> float:
    arrhenius = np.exp(-values["activation_energy"] / (GAS * (temperature + 273.15)))
    return float(values["coefficient"] * f ** values["exponent"] * arrhenius)


def drawn(draw: st.DrawFn, stress: float, rate: float, temperature: float) -> dict[str, float]:
    exponent, energy = draw(st.floats(0.7, 8.0)), draw(st.floats(0.0, 3e5))
    arrhenius = np.exp(-energy / (GAS * (temperature + 273.15)))
    coefficient = rate / stress**exponent / arrhenius
    return {"coefficient": coefficient, "exponent": exponent, "activation_energy": energy}


@pytest.mark.parametrize("place", ["solid", "liquid"])
@given(q=st.floats(1e5, 1e9), step=st.floats(1e-3, 1e3))
def test_tables_over_temperature(place: str, q: float, step: float) -> None:
    """No yield stress or hardening, in the solid as in the liquid."""
    keys: dict[str, Any] = {
        "coefficient": [[0, 1e-40], [400, 3e-40]],
        "exponent": [[0, 5.0], [400, 4.0]],
        "activation_energy": [[0, 1.2e5], [400, 1.6e5]],
    }
    if place == "solid":
        extra = {"yield_stress": 5e7, "hardening": 1e9, "kinematic_hardening": 1e9}
        material = alloy(law="norton", **keys, **extra)
        properties = solid_flow(material, VISCOPLASTIC, MODULUS, TEMPERATURE, step)
    else:
        material = alloy(liquid={"model": "norton", "coherency": 0.7, **keys})
        properties = liquid_flow(material, MODULUS, TEMPERATURE, step)
    rate = (
        np.array([1.5e-40, 3e-40])
        * q ** np.array([4.75, 4.0])
        * np.exp(-np.array([1.3e5, 1.6e5]) / (GAS * (TEMPERATURE + 273.15)))
    )
    np.testing.assert_allclose(properties.overstress(rate * step), q, rtol=1e-10)
    for name in ("yield_stress", "hardening_modulus", "kinematic_modulus"):
        assert not getattr(properties, name).any()
    assert not properties.hardening_curves
    np.testing.assert_array_equal(properties.shear_modulus, MODULUS)


@pytest.mark.parametrize("temperature", [-273.15, -273.0, -200.0, 1e4])
@pytest.mark.parametrize("step", [1e-6, 1e4])
def test_numbers_at_every_temperature(temperature: float, step: float) -> None:
    keys = {"coefficient": 1e-40, "exponent": 5, "activation_energy": 1.4e5}
    material = alloy(law="norton", **keys)
    properties = solid_flow(material, VISCOPLASTIC, MODULUS, np.full(2, temperature), step)
    resistance = properties.overstress(np.ones(2))
    assert np.isfinite(resistance).all() and (resistance > 0.0).all()
