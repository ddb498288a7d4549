"""Studies without a solver: a case file, and runs that answer by a formula."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from castx.case.reading.read import load_case
from castx.studies.runs.answers import ANSWERS
from castx.studies.runs.executor import Ended, Task

CASE = """
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
cells = "quadrilaterals"
radius = "30 mm"
height = "1 mm"
wall = "25 mm"
size = "2.5 mm"
[materials.metal]
density = 2600
heat_capacity = 1000
conductivity = 150
latent_heat = 396154
solidus = 557
liquidus = 613
[materials.die]
density = 7800
heat_capacity = 500
conductivity = 35
[[bodies]]
name = "casting"
material = "metal"
temperature = 670
[[bodies]]
name = "mould"
material = "die"
temperature = "200 degC"
[[interfaces]]
bodies = ["casting", "mould"]
heat = { law = "constant", closed = "2000 W/m^2/K" }
[coupling]
scheme = "thermal"
[time]
end = 6
fixed_step = 1
[output]
fields = ["temperature"]
[[probes]]
name = "near"
body = "mould"
below = "casting/mould"
depth = "2 mm"
at = ["30 mm", "0.5 mm"]
quantities = ["temperature"]
"""

Content = Mapping[str, Any]
Formula = Callable[[Content], tuple[Mapping[str, float], Mapping[str, Sequence[float]]]]
"""Answers, and the columns of probes.csv with the time, of the content of a case."""


class Formulas:
    """Executor that asks a formula in place of a solver.

    A formula that raises `RuntimeError` is a run that does not converge.

    Attributes:
        made: contents of the cases that were run.
        dies_after: number of runs after which it is interrupted.
    """

    def __init__(self, formula: Formula, dies_after: int | None = None) -> None:
        self.formula, self.dies_after = formula, dies_after
        self.made: list[Content] = []

    def ended(self, tasks: Sequence[Task]) -> Iterator[tuple[int, Ended]]:
        for index, task in reversed(list(enumerate(tasks))):  # never in their order
            if len(self.made) == self.dies_after:
                raise KeyboardInterrupt
            given = dict(zip(task.arguments[2::2], task.arguments[3::2], strict=True))
            sets = [b for a, b in zip(task.arguments[2::2], task.arguments[3::2], strict=True)
                    if a == "--set"]  # fmt: skip
            case = load_case(Path(task.arguments[1]), sets)
            self.made.append(case.content)
            try:
                answers, columns = self.formula(case.content)
            except RuntimeError as error:
                yield index, Ended(3, f"not converged: {error}", 0.1, 0.1)
                continue
            write_results(Path(given["--output"]), case.digest, answers, columns)
            yield index, Ended(0, "done", 0.1, 0.1)


def write_results(
    folder: Path, digest: str, answers: Mapping[str, float], columns: Mapping[str, Sequence[float]]
) -> None:
    """Write a results folder with what studies read of it."""
    folder.mkdir()
    record = {
        "castx": "0", "case": {"digest": digest}, "model": "axisymmetric", "bodies": {"casting": {}}
    }  # fmt: skip
    (folder / "run.json").write_text(json.dumps(record))
    (folder / "history.csv").write_text("time\n0\n1\n")
    lines = [",".join(columns), *(",".join(map(repr, row)) for row in zip(*columns.values(),
                                                                         strict=True))]  # fmt: skip
    (folder / "probes.csv").write_text("\n".join(lines) + "\n")
    rows = [(name, value, "s", 1.0, False) for name, value in answers.items()]
    (folder.parent / ANSWERS).write_text(json.dumps(rows))
