"""The solid fraction of a temperature, for runs that solve no heat equation."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.lookup import find_material

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("name", ["Al-pure", "AlSi7Mg", "steel-H13"])
def test_fraction_of_a_temperature_is_that_of_its_enthalpy(name) -> None:
    material = find_material(name, {})
    T = np.linspace(100.0, 800.0, 1401, dtype=np.float64)
    expected = material.enthalpy.solid_fraction(material.enthalpy.enthalpy(T))
    assert np.abs(material.solid_fraction_at(T) - expected).max() < 1e-4
