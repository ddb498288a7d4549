"""vary.html: what matters in a case, as bars, bands of curves and a table of runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from castx.arrays import FloatArray
from castx.report.page.assets import CURVES_ONLY, page
from castx.report.page.charts import Panel, Section, merged
from castx.studies.asked.vary import Vary
from castx.studies.importance import Importance
from castx.studies.runs.curves import Band
from castx.studies.table import StudyTable, with_unit

UPWARD, DOWNWARD = "#c0504d", "#4f81bd"
LONGEST_TABLE = 500
"""Runs that the page lists; the table on disk has all."""


def vary_page(
    name: str,
    study: Vary,
    table: StudyTable,
    importance: Sequence[Importance],
    bands: Sequence[Band],
) -> str:
    """Return the page of a study.

    Args:
        name: of the case.
        study: what was asked.
        table: the runs.
        importance: of the answers that vary.
        bands: of the curves.
    """
    runs = table.runs
    failed = sum(not run.is_finished for run in runs)
    told = f"{len(runs)} runs, {study.method}, {failed} failed."
    return page(
        "vary.html.j2",
        CURVES_ONLY,
        name=name,
        told=told + " Changes are those from the lowest to the highest value of an input.",
        importance=importance,
        bars=bars,
        curves=merged({name: band_sections(bands)}),
        heads=headings(table),
        rows=rows(table),
    )


def bars(one: Importance) -> list[Mapping[str, object]]:
    """Return the tornado of an answer: a bar for each input, to the right where it grows."""
    changes = [effect.change for effect in one.effects]
    most = max((abs(change) for change in changes if np.isfinite(change)), default=0.0)
    found: list[Mapping[str, object]] = []
    for effect in one.effects:
        known = np.isfinite(effect.change) and most > 0.0
        width = 50.0 * abs(effect.change) / most if known else 0.0
        upward = effect.change > 0.0
        found.append({
            "name": effect.name,
            "change": f"{effect.change:+.3g}" if np.isfinite(effect.change) else "–",
            "more": [f"{value:.3g}" for value in effect.more.values()],
            "left": f"{50.0 if upward else 50.0 - width:.1f}",
            "width": f"{width:.1f}",
            "colour": UPWARD if upward else DOWNWARD,
        })  # fmt: skip
    return found


def band_sections(bands: Sequence[Band]) -> list[Section]:
    """Return the diagrams of the bands: what 5, 50 and 95 % of the runs are below."""
    panels = [
        Panel(
            f"{band.column} [{probe_unit(band.column)}]",
            {"5 %": band.low, "50 %": band.middle, "95 %": band.high},
        )
        for band in bands
    ]
    if not panels:
        return []
    told = "What 5, 50 and 95 % of the runs are below at each moment."
    return [Section("Curves of the probes", told, bands[0].time, panels)]


def probe_unit(column: str) -> str:
    """Return the unit of a column of probes.csv."""
    from castx.results.states.quantities import UNITS  # loads the solvers

    return UNITS[column.split(".")[1]]


def headings(table: StudyTable) -> list[str]:
    """Return the heads of the table of runs."""
    inputs = [with_unit(name, unit) for name, unit in zip(table.inputs, table.units, strict=True)]
    return ["run", "ended", *inputs, *(with_unit(of, table.unit(of)) for of in table.varied())]


def rows(table: StudyTable) -> list[list[str]]:
    """Return the lines of the table of runs, of the first ones if there are very many."""
    results = [table.result(name) for name in table.varied()]
    return [
        [
            run.folder.rpartition("/")[2],
            run.ended if run.is_finished else f"{run.ended}: {run.said}",
            *(f"{value:.5g}" for value in table.values[index]),
            *(_text(of[index]) for of in results),
        ]
        for index, run in enumerate(table.runs[:LONGEST_TABLE])
    ]


def _text(value: FloatArray) -> str:
    return "–" if np.isnan(value) else f"{value:.5g}"
