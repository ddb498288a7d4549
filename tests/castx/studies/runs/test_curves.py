"""Bands of curves."""

from types import SimpleNamespace

import numpy as np
import pytest

from castx.results.files.run_tables import Columns
from castx.studies.runs.curves import curve_bands

pytestmark = pytest.mark.serial


def run(slope, end, **more):
    time = np.linspace(0.0, end, 7)
    return SimpleNamespace(probes=Columns(time=time, a=slope * time, **more))


def test_bands_of_straight_lines():
    """Slopes 0, 1 … 100: 5 % lie below 5, half below 50, over the shortest run."""
    runs = [run(slope, 2.0 if slope else 1.0) for slope in range(101)]
    (band,) = curve_bands(runs)
    assert band.column == "a" and band.time[-1] == 1.0
    for line, slope in ((band.low, 5.0), (band.middle, 50.0), (band.high, 95.0)):
        np.testing.assert_allclose(line, slope * band.time, atol=1e-12)


def test_columns_that_are_not_everywhere_have_none():
    some = run(1.0, 1.0, b=np.zeros(7), c=np.full(7, np.nan))
    other = run(2.0, 1.0, c=np.zeros(7))
    assert [band.column for band in curve_bands([some, other])] == ["a"]
