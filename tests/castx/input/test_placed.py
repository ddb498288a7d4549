"""Numbers that vary with place and time, by a formula or a table."""

import numpy as np
import pytest

from castx.errors import CaseError
from castx.input.entries import Quantity
from castx.input.placed import PlacedOverTime, Placing
from castx.input.units import STRESS
from castx.tables import Table

pytestmark = pytest.mark.serial

KIND = PlacedOverTime(Quantity(STRESS))
POINTS = np.array([[3.0, 4.0, 7.0], [0.0, 0.5, 1.0]])
GRID = [["1 m", 0, "4 MPa"], [0, 0, 0], [0, "1 min", 6e6], [1, 60, 18e6]]


def test_numbers_and_tables_over_time_stay_what_they_are():
    assert isinstance(KIND.read("2 MPa"), Table)
    assert KIND.read([[0, 1], [10, 2]])(5.0) == 1.5


def test_a_formula_knows_place_and_time():
    found = KIND.read({"formula": "r + 10*z + 100*t"})
    np.testing.assert_allclose(found(POINTS, 2.0), [5.0 + 70.0 + 200.0, 0.5 + 10.0 + 200.0])
    assert found.axes == ("z", "r", "t")
    np.testing.assert_array_equal(KIND.read({"formula": "7"})(POINTS, 0.0), [7.0, 7.0])
    assert KIND.read(found) is found


def test_a_table_of_one_coordinate():
    found = KIND.read({"along": "z", "table": [[0, 0], ["2 m", "4 Pa"]]})
    np.testing.assert_allclose(found(POINTS, 9.0), [4.0, 2.0])


def test_a_table_of_two_is_linear_between_its_points_and_constant_outside():
    """Its four corners are those of 4 x + 0.1 t + 8/60 x t, in MPa; rows come in any order."""
    found = KIND.read({"along": ["x", "t"], "table": GRID})
    for x, t in ((0.25, 15.0), (1.0, 60.0), (0.0, 0.0), (0.5, 60.0)):
        exact = 4e6 * x + 1e5 * t + 8e6 / 60.0 * x * t
        assert found([[x, 0.0]], t)[0] == pytest.approx(exact)
    assert found([[5.0, 0.0]], 99.0)[0] == 18e6 and found([[-5.0, 0.0]], 0.0)[0] == 0.0
    assert found.text == "0 to 1.8e+07 along x and t"


@pytest.mark.parametrize(
    "value, text",
    [
        ({"formula": 3}, "formula: a formula in quotes"),
        ({"formula": "z + q"}, "formula: 'q' means nothing"),
        ({"formula": "z", "along": "z"}, "along: unknown key"),
        ({"along": "z"}, "table: missing"), ({}, "along: missing"),
        ({"along": ["z", "z"], "table": GRID}, "along: two different"),
        ({"along": ["x", "y", "z"], "table": GRID}, "along: one coordinate or a list of two"),
        ({"along": [["x"]], "table": GRID}, "along: unknown"),
        ({"along": "q", "table": GRID}, "along: unknown; allowed: x, y, z, r, t"),
        ({"along": ["x", "t"], "table": 5}, "table: 4 to 10000 rows"),
        ({"along": ["x", "t"], "table": [*GRID[:3], [1, 60]]}, r"table\[3\]: a row needs three"),
        ({"along": ["x", "t"], "table": [*GRID[:3], [1, "1 m", 0]]}, r"table\[3\]: 'm' is not"),
        ({"along": ["x", "t"], "table": [*GRID[:3], [2, 60, 1]]}, "table: the rows must fill"),
        ({"along": ["x", "t"], "table": [*GRID, GRID[0]]}, "table: the rows must fill"),
    ],
)  # fmt: skip
def test_refused(value, text):
    with pytest.raises(CaseError, match=text):
        KIND.read(value)


def test_a_number_of_the_start_has_no_time():
    with pytest.raises(CaseError, match="'t' means nothing"):
        Placing(Quantity(STRESS)).read({"formula": "t"})
