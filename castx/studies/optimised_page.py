"""optimised.html: the best numbers of a case, all trials over each of them, and their table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.report.page.assets import CURVES_ONLY, data_uri, page
from castx.report.style import COLOURS, DOTS_PER_INCH, figure
from castx.studies.asked.optimise import LEAST, Optimise
from castx.studies.page import headings, rows
from castx.studies.table import StudyTable, with_unit

HEIGHT, WIDTH = 3.0, 3.2
"""Of the diagram of one number [inch]."""
IN_A_ROW = 3
BEYOND = "#b5b8be"


def optimised_page(
    name: str,
    study: Optimise,
    table: StudyTable,
    within: BoolArray,
    best: int,
    remarks: Sequence[str],
) -> str:
    """Return the page of a study.

    Args:
        name: of the case.
        study: what was asked.
        table: the runs, in the order in which they were made.
        within: whether each keeps all limits, (runs,).
        best: index of the best one.
        remarks: on it, in words.
    """
    runs = table.runs
    failed = sum(not run.is_finished for run in runs)
    return page(
        "optimised.html.j2",
        CURVES_ONLY,
        name=name,
        told=f"{len(runs)} runs, {study.method}, {failed} failed.",
        goal=f"the {study.direction} of {study.goal!r}",
        remark=" ".join(remarks),
        numbers=best_numbers(table, best),
        answers=best_answers(study, table, best),
        picture=picture(table, study, within, best),
        heads=headings(table),
        rows=rows(table),
    )


def best_numbers(table: StudyTable, best: int) -> list[tuple[str, str]]:
    """Return the numbers of the best run with their names."""
    named = zip(table.inputs, table.units, table.values[best], strict=True)
    return [(with_unit(name, unit), f"{value:.5g}") for name, unit, value in named]


def best_answers(study: Optimise, table: StudyTable, best: int) -> list[tuple[str, str]]:
    """Return the goal and the answers with limits of the best run, with the limits."""
    found = []
    bounds = {one.of: one for one in study.limits}
    for name in dict.fromkeys((study.goal, *bounds)):
        answer = table.found[best][name]
        ends = []
        if name in bounds:
            limit = bounds[name]
            ends += [] if limit.least is None else [f"at least {limit.least:.5g}"]
            ends += [] if limit.most is None else [f"at most {limit.most:.5g}"]
        behind = f" ({', '.join(ends)})" if ends else ""
        found.append((with_unit(name, answer.unit), f"{answer.shown:.5g}{behind}"))
    return found


def best_so_far(goal: FloatArray, within: BoolArray, direction: str) -> FloatArray:
    """Return the best answer within all limits up to each run, NaN before the first, (runs,)."""
    of = np.fmin if direction == LEAST else np.fmax
    return np.asarray(of.accumulate(np.where(within, goal, np.nan)))


def picture(table: StudyTable, study: Optimise, within: BoolArray, best: int) -> str:
    """Return the goal of all runs over each number and over their order, as a data URI."""
    goal = table.result(study.goal)
    heads = [with_unit(*pair) for pair in zip(table.inputs, table.units, strict=True)]
    order = np.asarray(np.arange(1, len(goal) + 1), dtype=np.float64)
    panels = dict(zip(heads, map(np.asarray, table.values.T), strict=True)) | {"run": order}
    lines = -(-len(panels) // IN_A_ROW)
    with figure(IN_A_ROW * WIDTH, lines * HEIGHT) as (canvas, stream):
        axes = canvas.subplots(lines, IN_A_ROW, squeeze=False).ravel()
        for axis, (head, values) in zip(axes, panels.items(), strict=False):
            axis.plot(values[~within], goal[~within], "o", color=BEYOND, label="beyond a limit")
            axis.plot(values[within], goal[within], "o", color=COLOURS[0], label="within limits")
            axis.plot(values[best], goal[best], "o", markersize=13, fillstyle="none",
                      color=COLOURS[1], label="best")  # fmt: skip
            axis.set(xlabel=head, ylabel=with_unit(study.goal, table.unit(study.goal)))
        last = axes[len(panels) - 1]
        last.plot(order, best_so_far(goal, within, study.direction), color=COLOURS[1],
                  drawstyle="steps-post")  # fmt: skip
        last.legend(fontsize=8)
        for axis in axes[len(panels) :]:
            axis.axis("off")
        canvas.savefig(stream, dpi=DOTS_PER_INCH, format="png")
    return data_uri(stream.getvalue())
