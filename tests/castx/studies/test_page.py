"""The page of a study: bars to the right where an answer grows."""

import numpy as np
import pytest

from castx.studies.importance import Importance, InputEffect
from castx.studies.page import band_sections, bars, probe_unit
from castx.studies.runs.curves import Band

pytestmark = pytest.mark.serial


def test_bars_show_sign_and_size():
    effects = (
        InputEffect("a", -4.0, 4.0, {"total index": 0.9}),
        InputEffect("b", 1.0, 1.0, {"total index": 0.1}),
        InputEffect("c", np.nan, np.nan, {}),
    )
    first, second, third = bars(Importance("t", "s", 0.0, 1.0, effects, ""))
    assert (first["left"], first["width"], first["change"]) == ("0.0", "50.0", "-4")
    assert (second["left"], second["width"], second["more"]) == ("50.0", "12.5", ["0.1"])
    assert (third["width"], third["change"]) == ("0.0", "–")


def test_bands_are_three_lines():
    time = np.array([0.0, 1.0])
    (section,) = band_sections([Band("near.temperature", time, time, 2 * time, 3 * time)])
    (panel,) = section.panels
    assert panel.label == "near.temperature [°C]" and list(panel.lines) == ["5 %", "50 %", "95 %"]
    assert band_sections([]) == []
    assert probe_unit("gap_mid.gap") == "m"
