"""Live progress of a run: a bar on a terminal, one plain line per step elsewhere; rank 0 only."""

from __future__ import annotations

import math
from contextlib import suppress
from datetime import timedelta
from types import TracebackType
from typing import Self

from mpi4py import MPI

from rich import progress
from rich.console import Console

from castx.command.terminal import console_of
from castx.input.units import seconds_text
from castx.process.remaining import Remaining
from castx.results.states.snapshot import Snapshot

WIDE = 105
"""Width of a terminal that has room for a bar beside the numbers."""


class Progress:
    """Shows each accepted step, with the wall clock time left.

    Args:
        end: end of the run [s].
        comm: ranks of the run.
        console: where to; by default the standard output of rank 0.
        largest: step [s].
    """

    def __init__(
        self,
        end: float,
        comm: MPI.Intracomm,
        console: Console | None = None,
        largest: float = math.inf,
    ) -> None:
        self._shown = comm.rank == 0
        self._console = console or console_of(comm)
        self._remaining = Remaining(end, largest)
        self._freezing: str | None = None
        bar = [progress.BarColumn(bar_width=20)] if self._console.width >= WIDE else []
        self._bar = progress.Progress(
            *bar,
            progress.TextColumn("{task.description}", markup=False),
            console=self._console,
            disable=not (self._shown and self._console.is_terminal),
        )
        self._task = self._bar.add_task("starting", total=end)

    def __enter__(self) -> Self:
        if not self._bar.disable:
            with suppress(OSError):
                self._bar.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if not self._bar.disable:
            with suppress(OSError):
                self._bar.stop()

    def show(self, snapshot: Snapshot) -> None:
        """Show the state after an accepted step."""
        if not self._shown:
            return
        # The first one shown is a later one after a restart.
        if self._freezing is None:
            self._freezing = freezing_body(snapshot)
        if snapshot.step > 0:
            self._remaining.note(snapshot, self._freezing)
        with suppress(OSError):  # of a terminal that was closed: the run goes on without it
            self._print(snapshot)

    def _print(self, snapshot: Snapshot) -> None:
        line = describe(snapshot, self._freezing, self._remaining.wall())
        if self._bar.disable:
            self._console.print(line, markup=False, highlight=False)
        else:
            self._bar.update(self._task, completed=snapshot.time, description=line)


def freezing_body(snapshot: Snapshot) -> str | None:
    """Return the column of the solid fraction of the first body that is not all solid."""
    for name, value in snapshot.totals.items():
        if name.endswith(".solid_fraction") and value < 1.0 - 1e-9:
            return name
    return None


def describe(snapshot: Snapshot, freezing: str | None, remaining: float | None) -> str:
    """Return a line of text about an accepted step.

    Args:
        snapshot: the state after it.
        freezing: column of the solid fraction to show; None: none freezes.
        remaining: wall clock time left [s]; None: not known yet.
    """
    counters = snapshot.counters
    parts = [f"t {seconds_text(snapshot.time)}", f"step {snapshot.step}"]
    if snapshot.step > 0:
        parts[-1] += f" ({seconds_text(counters.step, 3)})"
    if freezing is not None:
        # Rounding may leave less than nothing, which would be shown as -0.0.
        parts.append(f"solid {max(100.0 * snapshot.totals[freezing], 0.0):.1f} %")
    if snapshot.step > 0:
        parts.append(f"iterations {counters.heat_iterations}+{counters.mechanics_iterations}")
        parts.append(f"passes {counters.passes}")
    if counters.cutbacks:
        parts.append(f"cut {counters.cutbacks}×")
    if counters.repeats:
        parts.append(f"taken again {counters.repeats}×")
    if counters.fallbacks:
        parts.append(f"{counters.fallbacks} contact methods failed")
    if counters.unbalanced:
        parts.append(f"{counters.unbalanced} equilibria not balanced by sweeps")
    if counters.frozen_pairs:
        parts.append(f"{counters.frozen_pairs} pairs frozen")
    if remaining is not None:
        parts.append(f"left {timedelta(seconds=round(remaining))}")
    return "  ".join(parts)
