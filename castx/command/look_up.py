"""Commands that show a database or one of its entries."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType

from castx.command.terminal import output_of
from castx.ranks import on_first_rank

EntryName = Annotated[
    str | None, typer.Argument(metavar="[NAME]", help="Show all numbers of this one.")
]
EntryPlot = Annotated[
    Path | None, typer.Option(metavar="FILE", help="Draw the curves of NAME: .png, .svg or .pdf.")
]


def look_up(
    context: typer.Context,
    table: RenderableType,
    draw: Callable[[Path], None],
    name: str | None,
    plot: Path | None,
) -> None:
    """Show the table of a database or of one entry; draw that entry, or say how to draw it.

    Args:
        context: of the command.
        table: what it shows.
        draw: writes the figure of the entry.
        name: of the entry; None: the table is that of all.
        plot: file of the figure.
    """
    comm, console = output_of(context)
    command = context.info_name
    if name is None and plot is not None:
        raise typer.BadParameter(f"it draws one entry: castx {command} NAME --plot FILE")
    console.print(table)
    if name is not None and plot is None:
        console.print(f"curves: castx {command} {name} --plot {name}.png", markup=False)
    if plot is None:
        console.refuse_loss()
        return
    on_first_rank(comm, lambda: draw(plot))
    console.print(f"written: {plot}", markup=False)


def materials(
    context: typer.Context,
    name: EntryName = None,
    case_file: Annotated[
        Path | None,
        typer.Option("--case", metavar="CASE.toml", help="Take the materials of a case too."),
    ] = None,
    plot: EntryPlot = None,
) -> None:
    """List the materials of the database, or the numbers of one with units, ranges and sources."""
    from castx.case.reading.read import load_case
    from castx.command.listing import material_list, material_table
    from castx.materials.lookup import find_material

    given = {} if case_file is None else load_case(case_file).materials

    def draw(path: Path) -> None:
        from castx.report.material_figure import write_figure

        write_figure(find_material(name or "", given), path)

    table = material_list(given) if name is None else material_table(name, given)
    look_up(context, table, draw, name, plot)


def interfaces(context: typer.Context, name: EntryName = None, plot: EntryPlot = None) -> None:
    """List the interfaces of the database, or the numbers of one with units, ranges and sources."""
    from castx.command.listing import interface_list, interface_table

    def draw(path: Path) -> None:
        from castx.report.interface_figure import write_interface_figure

        write_interface_figure(name or "", path)

    table = interface_list() if name is None else interface_table(name)
    look_up(context, table, draw, name, plot)
