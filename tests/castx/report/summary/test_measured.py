"""Deviations from measured curves and forces that draw bodies."""

import pytest

from castx.report.summary.measured import deviations, ejection
from castx.results.files.measurements import Deviation
from tests.castx.report.summary.fake_run import run

pytestmark = pytest.mark.serial


def test_the_largest_deviation_comes_first_in_the_unit_of_a_difference():
    found = run(deviations={
        "a.temperature": Deviation(1.5, -3.0, 4.0, 7), "b.temperature": Deviation(2.5, 6.0, 8.0, 9)
    })  # fmt: skip
    first, second = deviations(found)
    assert first.name == "Beside its measurement: b.temperature" and first.number == "2.5 K"
    assert "at 7 points, at most -3 K at 4 s" in second.sentence
    (gap,) = deviations(run(deviations={"a.gap": Deviation(1e-6, 2e-6, 1.0, 3)}))
    assert gap.number == "1 µm" and "+2 µm" in gap.sentence


def test_the_last_force_to_draw_a_body_counts():
    forces = [{"force": f, "friction": 0.3, "normal": f / 0.3} for f in (300.0, 600.0)]
    found = run()
    found.record["process"] = [
        {"time": 10.0 * n, "cycle": n, "ejection": {"core": force}}
        for n, force in enumerate(forces)
    ]
    (drawn,) = ejection(found)
    assert drawn.number == "0.6 kN" and drawn.time == 10.0 and drawn.of == "core"
