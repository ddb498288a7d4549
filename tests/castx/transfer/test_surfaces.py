"""Entries about facing surfaces: coatings, roughness, what pressure adds, radiation."""

from __future__ import annotations

import pytest

from castx.errors import CaseError
from castx.transfer.surfaces import Coating, ContactConductance, Radiation, mean_depth

pytestmark = pytest.mark.serial


def test_resistance_of_a_coating_is_thickness_over_conductivity():
    assert Coating.read({"thickness": "0.3 mm", "conductivity": 0.4}).resistance == pytest.approx(
        7.5e-4
    )


def test_mean_depth_of_both_sides():
    assert mean_depth((30e-6, 40e-6)) == pytest.approx(25e-6)
    assert mean_depth((8e-6, 0.0)) == pytest.approx(4e-6)
    assert mean_depth(None) == 0.0


def test_a_pressure_term_has_one_resistance():
    own = {"hardness": 1e9, "roughness": [1e-6, 1e-6]}
    assert ContactConductance.read(own).rough
    assert not ContactConductance.read({"hardness": 1e9, "resistance": 1e-5}).rough
    with pytest.raises(CaseError, match="roughness: resistance is given already"):
        ContactConductance.read({**own, "resistance": 1e-5})


def test_emissivities_of_both_sides():
    assert Radiation.read({"emissivities": [0.3, 1]}).emissivities == (0.3, 1.0)
    with pytest.raises(CaseError, match=r"emissivities\[1\]: must be positive and at most 1"):
        Radiation.read({"emissivities": [0.3, 1.2]})


def test_the_default_exponent_is_that_of_rough_surfaces():
    assert ContactConductance.read({"hardness": 1e9}).exponent == 0.95
