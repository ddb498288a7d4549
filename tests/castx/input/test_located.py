"""Numbers of place and time at points: values, and means over a step."""

import numpy as np
import pytest

from castx.input.entries import Quantity
from castx.input.located import PlacedThere
from castx.input.placed import PlacedOverTime
from castx.input.units import STRESS

pytestmark = pytest.mark.serial

POINTS = np.array([[0.0, 0.5], [1.0, 2.0]])


def there(**value):
    return PlacedThere(PlacedOverTime(Quantity(STRESS)).read(value), POINTS)


def test_values_are_those_of_the_points():
    np.testing.assert_allclose(there(formula="x + 10*y + t")(3.0), [8.0, 24.0])


def test_means_of_formulas():
    """Of t⁹, and of a number without time, which is asked for once."""
    np.testing.assert_allclose(there(formula="y*t**9").mean(1.0, 2.0), [51.15, 204.6], rtol=1e-12)
    np.testing.assert_array_equal(there(formula="4*y").mean(0.0, 9.0), [2.0, 8.0])
    np.testing.assert_array_equal(there(formula="y*t").mean(2.0, 2.0), [1.0, 4.0])


def test_a_burst_within_a_step_counts_in_full():
    rows = [[y, t, y * q] for y in (0.0, 2.0) for t, q in ((1, 0), (1.1, 8), (1.3, 8), (1.4, 0))]
    found = there(along=["y", "t"], table=rows).mean(0.0, 6.0)
    np.testing.assert_allclose(found, np.array([0.5, 2.0]) * 8.0 * 0.3 / 6.0, rtol=1e-12)
    also = there(along="t", table=[[1, 0], [2, 6]]).mean(0.0, 3.0)
    np.testing.assert_allclose(also, [3.0, 3.0], rtol=1e-12)


def test_before_the_start_there_is_no_time():
    """The first step is asked for from -1 to 0 s, where a root has no value."""
    np.testing.assert_allclose(there(formula="y*(3 + sqrt(t))").mean(-1.0, 0.0), [1.5, 6.0])
