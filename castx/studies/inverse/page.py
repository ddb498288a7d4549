"""identified.html: estimates, what holds them, and curves with their bands on the measurements."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.report.page.assets import CURVES_ONLY, page
from castx.report.page.charts import Panel, Section, merged
from castx.studies.inverse.estimates import Estimates, IdentifiedNumber
from castx.studies.inverse.predictions import Prediction
from castx.studies.inverse.sensors import DEPTH, Sensors
from castx.studies.page import probe_unit
from castx.studies.table import with_unit

COMPUTED = (
    "Computed with all numbers that were found, place and clock of the sensor too, with the band "
    "of 95 %, on the measured curve."
)


def identified_page(
    name: str,
    found: Estimates,
    sensors: Sensors,
    tables: Sequence[Prediction],
    curves: Sequence[Prediction],
) -> str:
    """Return the page.

    Args:
        name: of the case.
        found: estimates.
        sensors: with their samples.
        tables: unknown tables with their bands.
        curves: of the sensors, with their bands.
    """
    sections = [
        *table_sections(tables),
        *curve_sections(found, sensors, curves),
    ]
    return page(
        "identified.html.j2",
        CURVES_ONLY,
        name=name,
        found=found,
        rows=[row(one) for one in found.estimates],
        words=[
            ("What to look at", found.remarks),
            ("What the samples do not see", found.unseen),
            ("Residuals", found.whiteness),
        ],
        curves=merged({name: sections}),
    )


def row(one: IdentifiedNumber) -> list[str]:
    """Return the line of an estimate in the table; depths are told in mm against the case."""
    if one.name.startswith(DEPTH) and one.unit == "m":
        return _depth_row(one)
    unit = f" {one.unit}" if one.unit else ""
    spread = f"{100.0 * one.deviation:.2g} %" if one.logarithmic else f"{one.deviation:.2g}{unit}"
    before = "nothing"
    if np.isfinite(one.known):
        before = f"{100.0 * one.known:.2g} %" if one.logarithmic else f"{one.known:.2g}{unit}"
    value = f"{one.value:.5g}{unit}" + (", at its bound" if one.at_bound else "")
    band = f"{one.low:.4g} to {one.high:.4g}"
    return [one.name, value, band, spread, f"{one.start:.5g}", before]


def _depth_row(one: IdentifiedNumber) -> list[str]:
    value, low, high = (1e3 * x for x in (one.value, one.low, one.high))
    held = ", at its bound" if one.at_bound else ""
    return [
        f"{one.name} against the case", f"{value:+.3g} mm{held}", f"{low:+.3g} to {high:+.3g} mm",
        f"{1e3 * one.deviation:.2g} mm", f"{1e3 * one.start:g}", f"{1e3 * one.known:.2g} mm",
    ]  # fmt: skip


def table_sections(tables: Sequence[Prediction]) -> list[Section]:
    """Return a diagram for each unknown table, over what it is a table of."""
    return [
        Section(one.name, "Identified table with its 95 % band.", one.argument, [table_panel(one)])
        for one in tables
    ]


def table_panel(one: Prediction) -> Panel:
    """Return the diagram of an unknown table."""
    lines = {"identified": one.value, "low": one.low, "high": one.high}
    return Panel(with_unit(one.name, one.unit), lines, abscissa=one.abscissa)


def curve_sections(
    found: Estimates, sensors: Sensors, curves: Sequence[Prediction]
) -> list[Section]:
    """Return for each sensor its computed curve on the measured one, and its residuals."""
    sections = []
    parts = sensors.parts(found.fit.residuals)
    for sensor, curve, part, told in zip(
        sensors.sensors, curves, parts, found.whiteness, strict=True
    ):
        unit = probe_unit(curve.name)
        difference = "K" if unit == "°C" else unit
        lines = {"computed": curve.value, "low": curve.low, "high": curve.high}
        points = {"computed": (sensor.time, sensor.values)}
        panels = [
            Panel(f"{curve.name} [{unit}]", lines, points=points),
            Panel(f"residual [{difference}]", {"measured - computed": part}),
        ]
        told = f"{COMPUTED} {told}"
        sections.append(Section(f"Sensor {curve.name}", told, sensor.time, panels))
    return sections
