"""Lines of the page of a study that identifies."""

from dataclasses import replace

import numpy as np
import pytest

from castx.studies.inverse.estimates import IdentifiedNumber
from castx.studies.inverse.identify import identify
from castx.studies.inverse.page import curve_sections, row, table_sections
from castx.studies.inverse.predictions import Prediction
from tests.castx.studies.inverse.measured_case import opened

pytestmark = pytest.mark.serial


def test_a_line_of_the_table():
    one = IdentifiedNumber("h", "W/m^2/K", 1234.56, 1100.0, 1400.0, 0.05, True, 900.0, np.inf, True)
    assert row(one) == [
        "h", "1234.6 W/m^2/K, at its bound", "1100 to 1400", "5 %", "900", "nothing",
    ]  # fmt: skip
    depth = IdentifiedNumber("depth", "m", 1e-4, 0.0, 2e-4, 5e-5, False, 0.0, 3e-4, False)
    assert row(depth)[3:] == ["5e-05 m", "0", "0.0003 m"]
    assert row(replace(depth, name="depth of TC 1")) == [
        "depth of TC 1 against the case", "+0.1 mm", "+0 to +0.2 mm", "0.05 mm", "0", "0.3 mm",
    ]  # fmt: skip
    assert row(replace(depth, name="depth of TC 1", at_bound=True))[1] == "+0.1 mm, at its bound"


def test_a_table_has_three_lines():
    x = np.array([0.0, 1.0])
    (section,) = table_sections([Prediction("h", x, x + 2, x + 1, x + 3)])
    (over_gap,) = table_sections([Prediction("h", x, x, x, x, "gap [um]", "W/m²/K")])
    assert (section.panels[0].abscissa, over_gap.panels[0].abscissa) == ("time [s]", "gap [um]")
    assert (section.panels[0].label, over_gap.panels[0].label) == ("h", "h [W/m²/K]")
    assert list(section.panels[0].lines) == ["identified", "low", "high"]


def test_a_sensor_has_its_curve_and_its_residuals(tmp_path):
    runner, study = opened(tmp_path)
    result = identify(runner, study)
    sensors = result.model.sensors
    (section,) = curve_sections(result.found, sensors, result.curves)
    assert section.title == "Sensor near.temperature" and section.caption.endswith(": noise.")
    curve, residual = section.panels
    assert (curve.label, residual.label) == ("near.temperature [°C]", "residual [K]")
    time, values = curve.points["computed"]
    np.testing.assert_array_equal(time, section.time)
    np.testing.assert_allclose(
        values - curve.lines["computed"], residual.lines["measured - computed"], atol=1e-9
    )
