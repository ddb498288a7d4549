"""Progress: a bar on a terminal, one plain line per step elsewhere, nothing on other ranks."""

import io

import pytest
from rich.console import Console

from castx.command.progress import Progress
from castx.solvers.counters import StepCounters
from tests.castx.fakes import FakeSnapshot


def show(comm, terminal):
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=terminal, width=200, quiet=comm.rank != 0)
    with Progress(10.0, comm, console, largest=0.5) as progress:
        for step in range(3):
            counters = StepCounters(
                step=0.5 if step else 0.0,
                wall=2.0 if step else 0.0,
                heat_iterations=7,
                mechanics_iterations=4,
                passes=3,
                cutbacks=step // 2,
                repeats=3 * (step // 2),
            )
            solid = 0.25 * step - 1e-9  # rounding may leave less than nothing
            totals = {"mould.solid_fraction": 1.0 - 1e-16, "casting.solid_fraction": solid}
            progress.show(FakeSnapshot(0.5 * step, step, None, totals=totals, counters=counters))
    return stream.getvalue()


@pytest.mark.ranks
def test_plain_lines(comm):
    lines = show(comm, False).splitlines()
    if comm.rank > 0:
        assert lines == []
        return
    assert lines == [
        "t 0 s  step 0  solid 0.0 %",
        "t 0.5 s  step 1 (0.5 s)  solid 25.0 %  iterations 7+4  passes 3  left 0:00:38",
        "t 1 s  step 2 (0.5 s)  solid 50.0 %  iterations 7+4  passes 3  cut 1×  "
        "taken again 3×  left 0:00:36",
    ]


@pytest.mark.serial
def test_a_bar_on_a_terminal(comm):
    text = show(comm, True)
    assert "\x1b[" in text and "━" in text
    assert "solid 50.0 %" in text and "left 0:00:36" in text


@pytest.mark.ranks
def test_the_solid_fraction_is_shown_after_a_restart(comm):
    stream = io.StringIO()
    console = Console(file=stream, force_terminal=False, width=200, quiet=comm.rank != 0)
    with Progress(10.0, comm, console) as progress:
        totals = {"casting.solid_fraction": 0.5}
        counters = StepCounters(step=1.0, wall=1.0)
        progress.show(FakeSnapshot(3.0, 3, None, totals=totals, counters=counters))
    assert ("solid 50.0 %" in stream.getvalue()) == (comm.rank == 0)
