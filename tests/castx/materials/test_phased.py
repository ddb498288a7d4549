"""A property of solid and liquid, blended by the solid fraction."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.phased import Phased
from castx.tables import Table

pytestmark = pytest.mark.serial

SOLID = Table.from_points([[0.0, 200.0], [500.0, 100.0]])
LIQUID = Table.from_points([[500.0, 60.0], [700.0, 80.0]])


def test_the_blend_is_linear_in_the_solid_fraction() -> None:
    temperature = np.array([250.0, 600.0, 600.0])
    fraction = np.array([1.0, 0.0, 0.25])
    found = Phased(SOLID, LIQUID)(temperature, fraction)
    np.testing.assert_allclose(found, [150.0, 70.0, 0.25 * 100 + 0.75 * 70], rtol=1e-14)


@pytest.mark.parametrize("phased", [Phased.uniform(SOLID), Phased(SOLID, LIQUID)])
def test_arguments_are_broadcast(phased: Phased) -> None:
    grid = phased(np.array([[100.0], [550.0]]), np.array([0.0, 0.5, 1.0]))
    assert grid.shape == (2, 3)
    for row, temperature in enumerate((100.0, 550.0)):
        for column, fraction in enumerate((0.0, 0.5, 1.0)):
            assert grid[row, column] == phased(temperature, fraction)


def test_what_both_phases_share_does_not_depend_on_the_fraction() -> None:
    fraction = np.linspace(0.0, 1.0, 5)
    np.testing.assert_array_equal(Phased.uniform(SOLID)(250.0, fraction), 150.0)
