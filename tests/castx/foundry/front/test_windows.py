"""Shares of a step between two solid fractions: of enthalpies and temperatures that fall evenly."""

import numpy as np
import pytest

from castx.foundry.front.windows import Window, enthalpy_at
from castx.materials.lookup import find_material
from tests.castx.foundry.front.test_passing import Curve

pytestmark = pytest.mark.serial


def test_the_share_of_a_step_in_a_range():
    window = Window(begin=10.0, end=4.0)
    start = np.array([12.0, 12.0, 8.0, 3.0, 12.0, 7.0, 10.0, 4.0])
    end = np.array([8.0, 2.0, 6.0, 9.0, 11.0, 7.0, 10.0, 4.0])
    exact = [0.5, 0.6, 1.0, 5.0 / 6.0, 0.0, 1.0, 0.0, 1.0]
    np.testing.assert_allclose(window.share(start, end), exact, rtol=1e-15)
    assert window.enters(start, end).tolist() == [True, True] + [False] * 6


def test_a_range_that_ends_on_a_plateau():
    """60 % have frozen at the eutectic, where the rest freezes: f = 0.9 lies on its plateau."""
    window = Window.of_enthalpies(Curve(), 0.5, 0.9)
    plateau = 2.7e6 * 560.0
    assert window.end == pytest.approx(plateau + 0.1 * 9.8e8, rel=1e-12)
    halfway = Curve().enthalpy(np.array([560.0 + 55.0 / 6.0]))[0]
    assert window.begin == pytest.approx(halfway, rel=1e-12)
    assert enthalpy_at(Curve(), 1.0) == pytest.approx(plateau, rel=1e-12)


def test_a_range_by_temperature():
    alloy = find_material("AlSi7Mg", {})
    window = Window.of_temperatures(alloy.enthalpy, 0.2, 0.4)
    found = alloy.solid_fraction_at(np.array([window.begin, window.end]))
    np.testing.assert_allclose(found, [0.2, 0.4], rtol=1e-9)
