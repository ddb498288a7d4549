"""The case with identified numbers."""

import pytest

from castx.case.reading.read import load_case
from castx.studies.inverse.identified_case import identified_case
from castx.studies.inverse.model import MeasuredCase
from tests.castx.studies.inverse.measured_case import opened

pytestmark = pytest.mark.serial


def test_numbers_depth_and_clock_are_those_found(tmp_path):
    runner, study = opened(tmp_path, depth=True, clock_deviation="1 s")
    model = MeasuredCase.of(runner, study)
    text = identified_case(model, {"h": 1234.5, "depth of near": 1e-4, "clock": 0.25})
    path = tmp_path / "new.toml"
    path.write_text(text)
    case = load_case(path)
    assert case.content["interfaces"][0]["heat"]["closed"] == "1234.5 W/m^2/K"
    assert case.probes[0].depth == pytest.approx(2.1e-3)
    (curve,) = case.measurements
    assert curve.start == -0.25 and curve.file == tmp_path / "near.csv"
    assert "[identify]" not in text and 'file = "near.csv"' in text
