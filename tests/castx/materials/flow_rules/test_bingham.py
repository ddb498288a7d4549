"""Bingham's flow rule: rate f/(3 viscosity)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from castx.materials.flow import VISCOPLASTIC, solid_flow
from castx.materials.flow_rules.bingham import overstress
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial


def rate(f: float, values: Mapping[str, float], temperature: float) -> float:
    return f / (3.0 * values["viscosity"])


def drawn(draw: st.DrawFn, stress: float, rate: float, temperature: float) -> dict[str, float]:
    return {"viscosity": stress / rate / 3.0}


@given(f=st.floats(1e5, 1e9), step=st.floats(1e-3, 1e3))
def test_tables_over_temperature(f: float, step: float) -> None:
    material = alloy(law="bingham", viscosity=[[100, 1e9], [500, 5e8]], yield_stress=0)
    modulus, temperature = np.array([20e9, 26e9]), np.array([100.0, 400.0])
    properties = solid_flow(material, VISCOPLASTIC, modulus, temperature, step)
    rate = f / (3 * np.array([1e9, 6.25e8]))
    np.testing.assert_allclose(properties.overstress(rate * step), f, rtol=1e-12)
    assert (properties.yield_stress == 0.0).all()


def test_a_shear_flow_has_the_viscosity() -> None:
    """τ = η γ̇: with q = √3 τ and ε̇ = γ̇/√3 the overstress is 3 η ε̇."""
    viscosity, shear_rate, step = 2e6, 0.4, 0.25
    found = overstress({"viscosity": np.array([viscosity])}, np.array([20.0]), step)
    stress = found(np.array([shear_rate / np.sqrt(3) * step]))[0]
    assert stress / np.sqrt(3) == pytest.approx(viscosity * shear_rate, rel=1e-14)
    assert not found.curved.any()
