"""The command `castx new`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from castx.case.processes.names import process_names
from castx.command.terminal import output_of
from castx.ranks import on_first_rank

_PROCESSES = " | ".join(process_names())


class Top(StrEnum):
    """The top of a part in its mould."""

    CLOSED = "closed"
    OPEN = "open"


def new(
    context: typer.Context,
    cad_file: Annotated[
        Path, typer.Argument(metavar="PART.step", help="CAD solids: .step, .iges or .brep.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="CASE.toml", help="Instead of PART.toml."),
    ] = None,
    process: Annotated[
        str | None, typer.Option(metavar="NAME", help=f"How it is cast: {_PROCESSES}.")
    ] = None,
    alloy: Annotated[str | None, typer.Option(metavar="NAME", help="See castx materials.")] = None,
    mould: Annotated[str | None, typer.Option(metavar="NAME", help="Its material.")] = None,
    split: Annotated[
        str | None, typer.Option(metavar="PLANE", help="Halves of the mould: z, or z=12mm.")
    ] = None,
    top: Annotated[
        Top, typer.Option(help="Whether the top of the part, along z, is open to the air.")
    ] = Top.CLOSED,
) -> None:
    """Write a case file for a CAD part: bodies, interfaces, first materials, sizes; a picture."""
    from castx.command.check import draw_new_case
    from castx.domain.cad.new_case import Wanted, write_new_case

    comm, console = output_of(context)
    target = cad_file.with_suffix(".toml") if output is None else output
    wanted = Wanted(process, alloy, mould, split, top is Top.OPEN)

    def say(text: str) -> None:
        console.print(text, markup=False, highlight=False)

    on_first_rank(comm, lambda: write_new_case(cad_file, target, wanted, say))
    console.print(f"written: {target}", markup=False)
    draw_new_case(target, comm, console)
    if process is None:
        console.print(
            "its interfaces, mould and times are guessed; those of a process are usual ones: "
            f"castx new {cad_file} --process NAME",
            markup=False,
        )
    console.print(f"look into it, then: castx check {target}", markup=False)
