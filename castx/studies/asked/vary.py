"""The table `[vary]`: which numbers of the case are varied, and how."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from castx.input.entries import Choice, Whole
from castx.input.problems import Problem
from castx.studies.asked.inputs import VariedInput
from castx.studies.asked.runner import Running

GRID, LATIN, MORRIS, SOBOL = "grid", "latin-hypercube", "morris", "sobol"
METHODS = (GRID, LATIN, MORRIS, SOBOL)
_USUAL = {GRID: 1, LATIN: 32, MORRIS: 10, SOBOL: 64}
_MOST_RUNS = 100_000


class Vary(Running):
    """A study that varies numbers of the case.

    Attributes:
        method: "grid": all combinations; "latin-hypercube": evenly spread; "morris": paths along
            one number after another; "sobol": shares of the variance.
        draws: runs of a Latin hypercube, paths of Morris, base points of Sobol (a power of two);
            None: 32, 10, 64.
        seed: of the random numbers; the same seed gives the same runs.
        inputs: the numbers.
    """

    method: Annotated[str, Choice(METHODS)] = LATIN
    draws: Annotated[int | None, Whole(2, _MOST_RUNS)] = None
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 0
    inputs: tuple[VariedInput, ...] = Field((), max_length=100)

    @property
    def number_of_draws(self) -> int:
        """Draws, the usual number if none is given."""
        return _USUAL[self.method] if self.draws is None else self.draws

    @property
    def number_of_runs(self) -> int:
        """How many runs the study makes at most."""
        count = len(self.inputs)
        per_draw = {LATIN: 1, MORRIS: count + 1, SOBOL: count + 2}
        if self.method != GRID:
            return self.number_of_draws * per_draw[self.method]
        return math.prod(len(one.values) if one.values else one.points for one in self.inputs)

    @property
    def fewest_runs(self) -> int:
        """Runs of a Latin hypercube that tell straight lines over all inputs; else one."""
        return len(self.inputs) + 2 if self.method == LATIN else 1

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield numbers named twice, values that only a grid takes, and too many runs."""
        if not self.inputs:
            yield Problem(("inputs",), "missing; at least one [[vary.inputs]] is needed")
            return
        for index, one in enumerate(self.inputs):
            earlier = self.inputs[:index]
            if one.of in [other.of for other in earlier]:
                yield Problem(("inputs", index, "of"), "is varied already; leave one out")
            if one.label in [other.label for other in earlier]:
                yield Problem(("inputs", index, "name"), "is there already; choose another one")
            if one.values is not None and self.method != GRID:
                text = f'are those of method = "{GRID}"; give low and high instead'
                yield Problem(("inputs", index, "values"), text)
        if self.method == GRID and self.draws is not None:
            yield Problem(("draws",), 'a grid has none: "points" of its inputs say how many runs')
        if self.method == SOBOL and self.number_of_draws & (self.number_of_draws - 1):
            low = 2 ** (self.number_of_draws.bit_length() - 1)
            yield Problem(("draws",), f"a power of two is needed, such as {low} or {2 * low}")
        if self.number_of_runs > _MOST_RUNS:
            yield Problem((), f"would make {self.number_of_runs} runs; at most {_MOST_RUNS}")
