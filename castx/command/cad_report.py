"""What `castx check` shows of CAD files: volumes and areas of the mesh beside those of the part."""

from __future__ import annotations

from collections.abc import Iterator

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from castx.meshes.cad.cells import POOR, Quality
from castx.meshes.cad.report import Measure, Report


def show_cad(report: Report, console: Console) -> None:
    """Show what was made of CAD files.

    Args:
        report: of the mesher.
        console: where to show it.
    """
    console.print(cad_table(report))
    console.print(quality_text(report.quality), markup=False)
    for remark in report.remarks:
        console.print(remark, markup=False)


def cad_table(report: Report) -> Table:
    """Return a table of volumes and areas in CAD and in the mesh."""
    headings = ("of CAD", "parts", "CAD", "mesh", "difference")
    table = Table(*headings, box=SIMPLE_HEAD)
    for unit, kind, measure in _rows(report):
        table.add_row(
            f"{kind} {measure.name}",
            str(measure.parts),
            f"{measure.cad:.6g} {unit}",
            f"{measure.mesh:.6g} {unit}",
            difference_text(measure),
        )
    return table


def quality_text(quality: Quality) -> str:
    """Return the quality of the cells in words."""
    place = ", ".join(f"{x:.4g}" for x in quality.place)
    return (
        f"{quality.cells} cells with edges of {quality.shortest:.3g} to {quality.longest:.3g} m; "
        f"quality {quality.mean:.2f} in the mean, {quality.worst:.2g} in the worst, at ({place}) "
        f"m, and below {POOR} in {quality.poor}"
    )


def _rows(report: Report) -> Iterator[tuple[str, str, Measure]]:
    yield from (("m³", "body", measure) for measure in report.bodies)
    yield from (("m²", "interface", measure) for measure in report.interfaces)
    yield from (("m²", "surface", measure) for measure in report.surfaces)


def difference_text(measure: Measure) -> str:
    """Return by how much the mesh differs from CAD, in percent."""
    percent = 100.0 * (measure.mesh / measure.cad - 1.0)
    return "0 %" if abs(percent) < 1e-6 else f"{percent:+.2g} %"
