"""Which runs belong to the options of `castx run`, and the tables behind them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import typer
from rich.console import RenderableType

from castx.command.terminal import VariedNumber

if TYPE_CHECKING:
    from castx.case.case import Case
    from castx.command.run import RunSettings

Solve: TypeAlias = "Callable[[Case, RunSettings], Path]"
MakeTable = Callable[[Path], RenderableType]


def chosen(
    sensitivity: VariedNumber | None, adapt: int, *, estimate: bool, profile: bool
) -> tuple[Solve, list[MakeTable]]:
    """Return the function that solves a case, and those of the tables behind it.

    Args:
        sensitivity: number that is varied.
        adapt: how often the mesh follows the errors.
        estimate: whether errors are estimated by a coarser mesh and larger steps.
        profile: whether the costs are told.

    Raises:
        typer.BadParameter: there is more than one reason for runs beside the run.
    """
    if [estimate, sensitivity is not None, adapt > 0].count(True) > 1:
        raise typer.BadParameter(
            "--adapt, --estimate and --sensitivity are runs of their own: take one"
        )
    from castx.command.run import run_case

    solve: Solve = run_case
    tables: list[MakeTable] = []
    if profile:
        from castx.command.listing import profile_table

        tables.append(profile_table)
    if sensitivity is not None:
        from castx.command.beside.sensitivity import run_sensitivity, sensitivity_table

        solve = run_sensitivity
        tables.append(sensitivity_table)
    if estimate:
        from castx.command.beside.estimate import estimate_table, run_estimate

        solve = run_estimate
        tables.append(estimate_table)
    if adapt:
        from castx.command.beside.adapted import adapted_table, run_adapted

        solve = partial(run_adapted, rounds=adapt)
        tables.append(adapted_table)
    return solve, tables
