"""The picture of a band: the runs as an area, what was measured as points on it."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from castx.proof.validation.band import MeasuredBand
from castx.proof.validation.band_page import curve_text, drawn_band
from castx.studies.runs.curves import Band

pytestmark = pytest.mark.serial

TIME = np.asarray(np.linspace(0.0, 10.0, 21), dtype=np.float64)
BAND = Band("a.gap", TIME, 1e-4 * TIME, 2e-4 * TIME, 3e-4 * TIME)


def pixels(curve: MeasuredBand) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(drawn_band(curve).picture)).convert("RGB"), dtype=int)


def test_measured_points_are_on_the_picture_and_in_its_text():
    bare = MeasuredBand(BAND, np.empty(0), np.empty(0))
    measured = MeasuredBand(BAND, TIME[1::2], 2.5e-4 * TIME[1::2])
    plain, dotted = pixels(bare), pixels(measured)
    assert plain.shape == dotted.shape
    orange = (dotted[..., 0] > 180) & (dotted[..., 2] < 80)
    assert orange.sum() > 100 > ((plain[..., 0] > 180) & (plain[..., 2] < 80)).sum()
    assert curve_text(measured).startswith("100 % of the measured moments")
    assert "no curve was read" in curve_text(bare)
    assert drawn_band(bare).image.startswith("data:image/png;base64,")
