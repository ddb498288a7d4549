"""Piecewise linear functions: values, means, slopes, refusals."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.tables import Table

pytestmark = pytest.mark.serial

TABLE = Table.from_points([[0.0, 1.0], [1.0, 3.0], [4.0, -3.0]])


def test_values_between_at_and_outside_the_points():
    arguments = np.array([[-5.0, 0.0, 0.5], [1.0, 2.5, 9.0]])
    np.testing.assert_allclose(TABLE(arguments), [[1.0, 1.0, 2.0], [3.0, 0.0, -3.0]])
    assert Table.constant(7.0)(arguments).tolist() == [[7.0] * 3] * 2


@pytest.mark.parametrize("start, end", [(-2.0, 6.0), (0.25, 0.75), (0.5, 3.0), (-3.0, -1.0)])
def test_the_mean_is_that_of_many_values(start, end):
    middles = start + (np.arange(200_000) + 0.5) * (end - start) / 200_000
    assert TABLE.mean(start, end) == pytest.approx(TABLE(middles).mean(), abs=1e-9)


def test_the_mean_over_nothing_is_the_value_there():
    assert TABLE.mean(2.5, 2.5) == 0.0 and TABLE.mean(3.0, 1.0) == TABLE(1.0)


def test_slopes_are_those_of_finite_differences():
    places = np.array([-1.0, 0.3, 0.9, 1.1, 3.9, 5.0])
    differences = (TABLE(places + 1e-6) - TABLE(places - 1e-6)) / 2e-6
    np.testing.assert_allclose(TABLE.derivative(places), differences, atol=1e-8)
    np.testing.assert_allclose(TABLE.derivative(np.array([0.0, 1.0, 4.0])), [2.0, -2.0, 0.0])


def test_a_table_is_constant_where_all_values_are_equal():
    assert Table.constant(3.0).is_constant and Table.from_points([[0, 2], [1, 2]]).is_constant
    assert not TABLE.is_constant


def test_the_numbers_of_a_table_cannot_be_changed():
    given = np.array([0.0, 1.0])
    table = Table(given, np.array([5.0, 6.0]))
    given[0] = 100.0
    assert table.arguments[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        table.values[0] = 1.0


@pytest.mark.parametrize(
    "arguments, values, text",
    [
        ([0.0, 1.0], [1.0], "as many values as arguments"),
        ([0.0, 0.0], [1.0, 2.0], "must increase strictly"),
        ([1.0, 0.0], [1.0, 2.0], "must increase strictly"),
        ([], [], "must increase strictly"),
        ([0.0, 1.0], [1.0, np.nan], "not finite"),
        ([0.0, np.inf], [1.0, 2.0], "not finite"),
    ],
)
def test_refused(arguments, values, text):
    with pytest.raises(CaseError, match=text):
        Table(np.array(arguments), np.array(values))


@pytest.mark.parametrize(
    "points, expected",
    [
        ([[0, 3], [5, 3], [9, 3]], []),
        ([[0, 0], [1, 1], [2, 2]], [0, 2]),
        ([[0, 0], [40, 0], [40.5, 9], [41, 0]], [0, 40, 40.5, 41]),
        ([[0, 0], [1, 1.05], [2, 2], [3, 5], [4, 8.1], [5, 11]], [0, 2, 5]),
    ],
)
def test_corners_are_where_straight_lines_would_miss_the_table(points, expected):
    """By more than 2 % of its range, here."""
    assert Table.from_points(points).corners(0.02).tolist() == expected


def test_rows_have_two_numbers():
    with pytest.raises(CaseError, match="rows of two numbers"):
        Table.from_points([[0.0, 1.0, 2.0]])
