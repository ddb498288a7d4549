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
