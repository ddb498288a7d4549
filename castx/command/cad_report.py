"""Output of `castx check` for CAD files: volumes and areas of the mesh beside those of the part."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from castx.input.units import plain_text
from castx.meshes.cad.cells import POOR, Quality
from castx.meshes.cad.report import Measure, Report

UNITS = {"cm³": 1e6, "cm²": 1e4}
"""In which volumes and areas are shown, by how many of them an SI unit has."""


def show_cad(report: Report, interfaces: Sequence[str], console: Console) -> None:
    """Print bodies, interfaces, mesh quality and remarks of CAD files.

    Args:
        report: of the mesher.
        interfaces: names that the case gives to its interfaces.
        console: where to show it.
    """
    console.print(cad_table(report, interfaces))
    console.print(quality_text(report.quality), markup=False)
    for remark in report.remarks:
        console.print(remark, markup=False)


def cad_table(report: Report, interfaces: Sequence[str]) -> Table:
    """Return a table of volumes and areas in CAD and in the mesh.

    Args:
        report: of the mesher.
        interfaces: names that the case gives to its interfaces; others are sorted.
    """
    headings = ("of CAD", "parts", "CAD", "mesh", "difference")
    table = Table(*headings, box=SIMPLE_HEAD)
    for unit, kind, name, measure in _rows(report, interfaces):
        table.add_row(
            f"{kind} {name}",
            str(measure.parts),
            f"{plain_text(UNITS[unit] * measure.cad, 6)} {unit}",
            f"{plain_text(UNITS[unit] * measure.mesh, 6)} {unit}",
            difference_text(measure),
        )
    return table


def quality_text(quality: Quality) -> str:
    """Return the quality of the cells in words."""
    place = ", ".join(f"{x:.4g}" for x in quality.place)
    poor = f"{quality.poor} cells are" if quality.poor else "none is"
    return (
        f"{quality.cells} cells with edges of {quality.shortest:.3g} to {quality.longest:.3g} m; "
        f"quality {quality.mean:.2f} in the mean, {quality.worst:.2g} in the worst, at ({place}) "
        f"m; {poor} below {POOR}"
    )


def _rows(report: Report, interfaces: Sequence[str]) -> Iterator[tuple[str, str, str, Measure]]:
    known = {frozenset(name.split("/")): name for name in interfaces}
    yield from (("cm³", "body", measure.name, measure) for measure in report.bodies)
    for measure in report.interfaces:
        name = known.get(frozenset(measure.name.split("/")), measure.name)
        yield "cm²", "interface", name, measure
    yield from (("cm²", "surface", measure.name, measure) for measure in report.surfaces)


def difference_text(measure: Measure) -> str:
    """Return the difference of the mesh from CAD in percent, as text."""
    percent = 100.0 * (measure.mesh / measure.cad - 1.0)
    return "0 %" if abs(percent) < 1e-6 else f"{percent:+.2g} %"
