"""The case file with the numbers that were identified, and the curves that told them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from castx.input.toml_written import toml_text
from castx.studies.asked.curves import SensorCurve
from castx.studies.asked.identify import CLOCK
from castx.studies.inverse.model import MeasuredCase
from castx.studies.runs.case_text import changed_content

HEAD = "# With numbers identified from measured curves by castx identify.\n\n"


def identified_case(model: MeasuredCase, values: Mapping[str, float]) -> str:
    """Return the text of the case with the values of all unknowns.

    Sensors lie where they were found to be, and clocks are set; the curves are its measurements, so
    that its report shows them. Files are named as in the case, relative to its folder.

    Args:
        model: the measured case.
        values: of all unknowns.
    """
    runner = model.runner
    found = model.parameters.changes(values)
    content = changed_content(runner.case_file, runner.overrides, found)
    for one in model.sensors.sensors:
        shift = values.get(one.depth_name, 0.0)
        probe = next(p for p in content["probes"] if p["name"] == one.probe.name)
        if len(one.rungs) and one.probe.below is not None:
            probe["depth"] = one.probe.depth + shift
        elif len(one.rungs):
            probe["at"] = [float(x) for x in one.moved(shift)]
    late = values.get(CLOCK, 0.0)
    curves = [_measurement(one.asked, late, runner.case_file) for one in model.sensors.sensors]
    others = [m for m in content.get("measurements", [])
              if m.get("of") not in [curve["of"] for curve in curves]]  # fmt: skip
    content["measurements"] = [*others, *curves]
    return HEAD + toml_text(content)


def _measurement(asked: SensorCurve, late: float, case_file: Path) -> dict[str, Any]:
    folder = case_file.resolve().parent
    file = asked.file
    given = {
        "of": asked.of,
        "file": str(file.relative_to(folder) if file.is_relative_to(folder) else file),
        "time": asked.time,
        "start": asked.start - late,
    }
    more = {"column": asked.column, "unit": asked.unit, "time_unit": asked.time_unit}
    return given | {key: value for key, value in more.items() if value}
