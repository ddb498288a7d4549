"""The law of one coefficient."""

from __future__ import annotations

import numpy as np
import pytest

from tests.castx.transfer.law_samples import BY_GAP, BY_PRESSURE, FALLING, coefficient

pytestmark = pytest.mark.serial


def test_the_gap_does_not_matter():
    gaps = np.array([-1e-6, 0.0, 1e-3])
    np.testing.assert_array_equal(coefficient({"law": "constant", "closed": 80}, gaps), [80.0] * 3)


def test_a_coating_alone():
    bare = {"law": "constant", "coating": {"thickness": 1e-4, "conductivity": 0.5}}
    assert coefficient(bare, 1.0) == pytest.approx(5000.0)


def test_tables_over_temperature_time_gap_and_pressure():
    heat = {"law": "constant", "closed": FALLING}
    assert coefficient(heat, secondary=200.0, primary=0.0) == pytest.approx(1200.0)
    other = {"law": "constant", "closed": {**FALLING, "of": "primary"}}
    assert coefficient(other, secondary=0.0, primary=450.0) == pytest.approx(1050.0)
    mean = {"law": "constant", "closed": {**FALLING, "of": "mean"}}
    assert coefficient(mean, secondary=300.0, primary=100.0) == pytest.approx(1200.0)
    timed = {"law": "constant", "closed": {"over": "time", "table": [[0, 100], ["1 min", 700]]}}
    assert coefficient(timed, time=30.0) == pytest.approx(400.0)
    assert coefficient({"law": "constant", "closed": BY_GAP}, 50e-6) == pytest.approx(550.0)
    found = coefficient({"law": "constant", "closed": BY_PRESSURE}, 0.0, [0.0, 5e6])
    assert found == pytest.approx([800.0, 2900.0])
