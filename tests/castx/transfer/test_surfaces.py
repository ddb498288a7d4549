"""Entries about facing surfaces: coatings, roughness, what pressure adds, radiation."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.transfer.surfaces import (
    Coating,
    ContactConductance,
    CurvedGap,
    Radiation,
    mean_depth,
)

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


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
@pytest.mark.parametrize("radii", [(2.0, 2.2), (2.2, 2.0)])
def test_a_curved_gap_conducts_as_its_shells_do(shape, radii):
    """The resistance per area of the first surface is ∫ (r_1/r)^n dr between both radii."""
    r = np.linspace(min(radii), max(radii), 20_001)
    share = (radii[0] / r) ** (1 if shape == "cylinder" else 2)
    exact = np.trapezoid(share, r)
    gap = CurvedGap.read({"shape": shape, "radii": list(radii)})
    found = gap.thickness(np.array([0.0, 0.2, 1e-6]))
    np.testing.assert_allclose(found, [0.0, exact, 1e-6], rtol=1e-6)
    assert np.isfinite(gap.thickness(np.array([99.0]))).all()


@pytest.mark.parametrize("shape, power", [("cylinder", 1), ("sphere", 2)])
def test_radiation_of_a_curved_gap_is_that_of_the_enclosure(shape, power):
    """Surface and space resistances in series give the heat; each side counts by its own area."""
    inner, outer, areas = 0.3, 0.7, (2.0**power, 3.0**power)
    resistance = (1 - inner) / inner / areas[0] + 1 / areas[0] + (1 - outer) / outer / areas[1]
    for radii, emissivities, area in (
        ([2, 3], (inner, outer), areas[0]), ([3, 2], (outer, inner), areas[1]),
    ):  # fmt: skip
        gap = CurvedGap.read({"shape": shape, "radii": radii})
        assert gap.facing_factor(emissivities) == pytest.approx(1 / resistance / area, rel=1e-12)


def test_radii_of_a_curved_gap_differ():
    with pytest.raises(CaseError, match="radii: two different radii"):
        CurvedGap.read({"shape": "sphere", "radii": [1, "100 cm"]})
