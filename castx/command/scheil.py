"""The command `castx scheil`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from castx.command.terminal import output_of
from castx.ranks import on_first_rank


def scheil(
    context: typer.Context,
    database: Annotated[Path, typer.Argument(metavar="FILE.tdb", help="Thermodynamic database.")],
    alloy: Annotated[
        list[str],
        typer.Argument(metavar="BASE SYMBOL=PERCENT…", help="By mass, such as AL SI=7 MG=0.3."),
    ],
    step: Annotated[float, typer.Option(metavar="K", help="Largest step of temperature.")] = 1.0,
    rest: Annotated[
        float, typer.Option(metavar="SHARE", help="Liquid that freezes at one temperature.")
    ] = 0.01,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE.toml", help="Else the screen.")
    ] = None,
) -> None:
    """Write the solid fraction of an alloy after Scheil as a material of a case file."""
    from castx.materials.scheil import Composition, case_text, scheil_table

    comm, console = output_of(context)

    def written() -> str:
        named = Composition.of(alloy)
        text = case_text(scheil_table(database, named, step, rest), database, named)
        if output is None:
            return text
        output.write_text(text)
        return f"written: {output}"

    console.print(on_first_rank(comm, written), markup=False)
