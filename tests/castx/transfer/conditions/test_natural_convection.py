"""Heat condition `natural-convection`: fluxes of warm and cold walls, by hand and by Nusselt."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.boundaries import HeatCondition
from castx.errors import CaseError
from tests.heat_conditions import flux_law

pytestmark = pytest.mark.serial


def test_fluxes_by_hand_on_both_sides_of_the_ambient():
    """16^¼ = 2 and 81^¼ = 3: h = 2.84 and 4.26 W/m²/K at a wall of 1 m."""
    law = flux_law("natural-convection", height=1.0, ambient=20.0)
    flux, slope = law(0.0, 1.0, np.array([36.0, 101.0, 20.0, 4.0]))
    assert flux == pytest.approx([-2.84 * 16.0, -4.26 * 81.0, 0.0, 2.84 * 16.0], rel=1e-12)
    assert slope == pytest.approx([-3.55, -5.325, 0.0, -3.55], rel=1e-12)


def test_a_lower_wall_cools_faster():
    """A sixteenth of the height doubles h."""
    low, high = (
        flux_law("natural-convection", height=height, ambient=20.0)(0.0, 1.0, np.array([300.0]))[0]
        for height in ("62.5 mm", "1 m")
    )
    assert low == pytest.approx(2.0 * high, rel=1e-12)


def test_it_is_close_to_the_nusselt_number_of_a_laminar_plate():
    """Nu = 0.59 (Gr Pr)^¼ with properties of air at the film of 47 °C, wall of 0.3 m at 72 °C."""
    conductivity, viscosity, prandtl = 0.0277, 1.77e-5, 0.705
    grashof = 9.81 / 320.0 * 50.0 * 0.3**3 / viscosity**2
    h = conductivity / 0.3 * 0.59 * (grashof * prandtl) ** 0.25
    law = flux_law("natural-convection", height=0.3, ambient=22.0)
    assert law(0.0, 1.0, np.array([72.0]))[0] == pytest.approx(-50.0 * h, rel=0.06)


def test_the_ambient_enters_by_its_mean():
    law = flux_law("natural-convection", height=1.0, ambient=[[0, 0], [10, 40]])
    assert law(2.0, 6.0, np.array([32.0]))[0] == pytest.approx(-2.84 * 16.0)


@pytest.mark.parametrize("wrong", [{}, {"height": 0.0}, {"height": [[0, 1], [5, 2]]}])
def test_one_height_is_needed(wrong):
    with pytest.raises(CaseError, match="height"):
        HeatCondition.read({"type": "natural-convection", "ambient": 20.0} | wrong)
