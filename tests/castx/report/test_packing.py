"""Arrays that were packed come back."""

import json

import numpy as np
import pytest

from castx.report.packing import LEVELS, packed, packed_values, unpacked

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("kind", [np.uint16, np.uint32, np.float32])
def test_arrays_come_back_as_they_were(kind):
    array = (100 * np.random.default_rng(1).random((7, 3))).astype(kind)
    np.testing.assert_array_equal(unpacked(json.loads(json.dumps(packed(array)))), array)


def test_wide_numbers_become_those_of_32_bits():
    assert packed(np.arange(3))["type"] == "uint32"
    assert packed(np.zeros(2))["type"] == "float32"


def test_fields_come_back_within_half_a_level():
    values = np.random.default_rng(2).normal(size=(5, 40)) * 1e8
    values[2, 7], values[:, 9] = np.nan, np.nan
    found = unpacked(json.loads(json.dumps(packed_values(values))))
    np.testing.assert_array_equal(np.isnan(found), np.isnan(values))
    step = (np.nanmax(values) - np.nanmin(values)) / LEVELS
    assert np.nanmax(np.abs(found - values)) <= 0.5001 * step
    extremes = [np.nanmin(values), np.nanmax(values)]
    assert [np.nanmin(found), np.nanmax(found)] == pytest.approx(extremes, rel=1e-12)


@pytest.mark.parametrize("value", [3.5, np.nan])
def test_a_field_without_a_range_comes_back(value):
    values = np.full((2, 3), value)
    np.testing.assert_array_equal(unpacked(packed_values(values)), values)
