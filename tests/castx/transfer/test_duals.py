"""Numbers with derivatives: every operation against complex steps and differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from castx.transfer.duals import Dual

pytestmark = pytest.mark.serial

X, Y = np.array([0.3, 2.0, -1.5]), np.array([1.2, 0.7, 0.9])
OPERATIONS: dict[str, Callable] = {
    "sum": lambda x, y: x + y,
    "difference": lambda x, y: x - y,
    "opposite": lambda x, y: -x,
    "product": lambda x, y: x * y,
    "product with itself": lambda x, y: x * x * y,
    "quotient": lambda x, y: x / y,
    "number": lambda x, y: (x * 3.0 + 1.5) / (y * 2.0),
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_derivatives_of_operations(name):
    """Derivatives by complex steps, exact to round-off."""
    operation, h = OPERATIONS[name], 1e-30
    found = operation(Dual.variable(X, 0, 2), Dual.variable(Y, 1, 2))
    np.testing.assert_allclose(found.value, operation(X, Y), rtol=1e-15)
    np.testing.assert_allclose(found.slopes[0], operation(X + 1j * h, Y + 0j).imag / h, rtol=1e-14)
    np.testing.assert_allclose(found.slopes[1], operation(X + 0j, Y + 1j * h).imag / h, rtol=1e-14)


def test_inverse_and_functions():
    y = Dual.variable(Y, 1, 2)
    np.testing.assert_allclose(y.inverse().slopes[1], -1.0 / Y**2, rtol=1e-14)
    sine = (y * 2.0).through(np.sin, np.cos)
    np.testing.assert_allclose(sine.value, np.sin(2.0 * Y))
    np.testing.assert_allclose(sine.slopes, [np.zeros(3), 2.0 * np.cos(2.0 * Y)])


def test_choices_take_values_with_their_slopes():
    x, y = Dual.variable(X, 0, 2), Dual.variable(Y, 1, 2)
    smaller, larger = X <= Y, X >= Y
    np.testing.assert_array_equal(x.minimum(y).value, np.minimum(X, Y))
    np.testing.assert_array_equal(x.minimum(y).slopes, [smaller, ~smaller])
    np.testing.assert_array_equal(x.maximum(y).value, np.maximum(X, Y))
    np.testing.assert_array_equal(x.maximum(y).slopes, [larger, ~larger])
    np.testing.assert_array_equal(x.minimum(x * 1.0 + 0.0).slopes[0], 1.0)
    chosen = x.where(np.array([True, False, True]), 5.0)
    np.testing.assert_array_equal(chosen.value, [X[0], 5.0, X[2]])
    np.testing.assert_array_equal(chosen.slopes[0], [1.0, 0.0, 1.0])


def test_a_part_of_the_points():
    part = Dual.variable(X, 0, 2).at(np.array([2, 0]))
    np.testing.assert_array_equal(part.value, X[[2, 0]])
    assert part.slopes.shape == (2, 2)
