"""report.html: one file with the findings, views, curves and numbers of a run."""

from __future__ import annotations

from pathlib import Path

from castx.report.browser_scene import scene
from castx.report.display import display
from castx.report.page.assets import SCRIPTS, page
from castx.report.page.charts import NUMERICS, merged, run_sections
from castx.report.page.shots import Shots, finding_shot, stills
from castx.report.reported import ReportedRun
from castx.report.summary.finding import Finding
from castx.report.summary.hot_spots import hot_spot_table
from castx.report.summary.registry import findings, leading
from castx.report.summary.rows import further_rows, numeric_rows
from castx.results.files.folder import REPORT, store_text


def write_report(folder: Path) -> Path:
    """Write report.html into a results folder and return its path.

    Raises:
        CaseError: the folder holds no results or no fields, or pictures cannot be drawn.
        StorageError: the page cannot be written.
    """
    run = ReportedRun(folder)
    found = findings(run)
    lead = leading(found)
    with display():
        pictures = shots_of(run, lead)
        still = stills(run)
    content = page(
        "report.html.j2",
        SCRIPTS,
        record=run.record,
        model=run.model,
        ended=run.record["exit"],
        lead=sorted(lead, key=lambda finding: finding.name not in pictures),
        others=[finding for finding in found if finding not in lead],
        shots=pictures,
        stills=still,
        rows=further_rows(run),
        numeric_rows=numeric_rows(run),
        hot_spots=hot_spot_table(run.record.get("hot_spots", []), run.model),
        curves=merged({run.case["name"]: run_sections(run)}),
        numerics=NUMERICS,
        scene=scene(run),
    )
    target = folder / REPORT
    store_text(target, content)
    return target


def shots_of(run: ReportedRun, found: list[Finding]) -> Shots:
    """Return the pictures of findings by their names, if any."""
    made = {finding.name: finding_shot(run, finding) for finding in found}
    return {name: shot for name, shot in made.items() if shot is not None}
