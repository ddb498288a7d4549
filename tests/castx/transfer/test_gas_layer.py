"""Laws without a bend: the roundings change nothing outside their width."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.transfer.conductance import VARIABLES
from castx.transfer.duals import Dual
from castx.transfer.gas_layer import rounded_gap, rounded_maximum
from tests.castx.transfer.law_samples import LIMITED, coefficient, conductance

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("law", ["limited", "series"])
@pytest.mark.parametrize("width", [5e-6, 40e-6, 200e-6])
def test_rounded_laws_have_no_bend(law, width):
    """The slope over the gap is continuous, zero at closure; outside the width nothing changes."""
    sharp, heat = {**LIMITED, "law": law}, {**LIMITED, "law": law, "transition": width}
    bend = 50e-6 if law == "limited" else 0.0  # k/closed, or closure
    low, high = (max(bend - width / 2, 0.0), bend + width / 2) if bend else (0.0, width)
    if low == 0.0 and bend:
        high = 2 * bend  # wider than the way to closure: the width that fits
    gaps = np.linspace(-1e-4, 3e-4, 8001)
    h = coefficient(heat, gaps)
    outside = (gaps <= low) | (gaps >= high)
    np.testing.assert_allclose(h[outside], coefficient(sharp, gaps)[outside], rtol=1e-10)
    inside = (gaps > low + 1e-7) & (gaps < high - 1e-7)
    assert (np.abs(h - coefficient(sharp, gaps))[inside] > 1e-9).all()
    bends = [np.abs(np.diff(np.diff(coefficient(x, gaps)) / np.diff(gaps))).max()
             for x in (sharp, heat)]  # fmt: skip
    assert bends[1] < 0.1 * bends[0]


def test_a_rounded_gap_leaves_closure_flat_and_meets_the_gap_with_its_slope():
    width, step = 1e-5, 1e-9
    assert rounded_gap(np.array([0.0, width, 3 * width]), width) == pytest.approx(
        [0.0, width, 3 * width]
    )
    gaps = np.array([0.0, step, width - step, width])
    found = np.diff(rounded_gap(gaps, width))[[0, 2]] / step
    assert found == pytest.approx([0.0, 1.0], abs=1e-3)
    gap = np.array([0.0, 2e-6])
    np.testing.assert_array_equal(rounded_gap(gap, 0.0), gap)


def test_a_rounded_maximum_carries_its_derivatives():
    """The parabola ((b − a) + w)²/4w between both, its slopes by differences."""

    def larger(x):
        a, b = (Dual.variable(value, k, VARIABLES) for k, value in enumerate(x))
        return rounded_maximum(a, b, Dual.constant(np.full(3, 0.5), VARIABLES))

    x = np.array([[1.0, 1.0, 1.0], [0.2, 1.2, 2.0]])
    found = larger(x)
    assert found.value == pytest.approx([1.0, 1.0 + 0.7**2 / 2.0, 2.0])
    for k in range(2):
        step = np.zeros((2, 1))
        step[k] = 1e-6
        rise = (larger(x + step).value - larger(x - step).value) / 2e-6
        assert found.slopes[k] == pytest.approx(rise, abs=1e-8)


@pytest.mark.parametrize("law", ["limited", "constant"])
def test_a_table_over_the_gap_may_end_at_zero(law):
    table = {"over": "gap", "table": [[0, 800], ["1 mm", 0]]}
    heat = {"law": law, "closed": 800, "open": table} if law == "limited" else {
        "law": law, "closed": table}  # fmt: skip
    found = conductance(heat, np.array([0.0, 5e-4, 1e-3, 2e-3]))
    np.testing.assert_allclose(found.coefficient.value, [800.0, 400.0, 0.0, 0.0])
    assert not found.coefficient.slopes.any()
    for rows in ([[0, 800], [1e-4, 0], [1e-3, 5]], [[0, 0]], [[0, 800], [1e-4, 0], [1e-3, 0]]):
        wrong = {"over": "gap", "table": rows}
        with pytest.raises(CaseError, match=r"must be positive.*; only the last row over gap"):
            conductance({**heat, "open" if law == "limited" else "closed": wrong}, 0.0)


def test_a_wide_curved_gap_conducts_otherwise_than_a_plane_one():
    """k/(R ln(1 + g/R)) between cylinders, in series with the contact."""
    curved = {"shape": "cylinder", "radii": [0.1, 0.2]}
    gas = 0.04 / (0.1 * np.log(2.0))
    assert coefficient({**LIMITED, "curved": curved}, 0.1) == pytest.approx(gas)
    series = coefficient({**LIMITED, "law": "series", "curved": curved}, 0.1)
    assert series == pytest.approx(1 / (1 / 800 + 1 / gas))
