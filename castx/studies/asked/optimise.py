"""The table `[optimise]`: what shall be best, within which limits, by which numbers."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from castx.input.entries import Choice, Description, Quantity, Whole
from castx.input.problems import Problem
from castx.input.units import PURE_NUMBER
from castx.studies.asked.inputs import LOG_UNIFORM, UNIFORM, VariedInput
from castx.studies.asked.runner import Running

EVOLUTION, SIMPLEX = "differential-evolution", "nelder-mead"
LEAST, MOST = "least", "most"
POPULATION = 3
"""Runs of a generation for each number, and four more."""
_AnswerName = Annotated[str, Field(min_length=1, max_length=200)]


class AnswerLimit(Description):
    """A limit on an answer.

    Attributes:
        of: name of the answer, as in table.csv without its unit.
        least: that it may have, in the unit of the table.
        most: that it may have.
    """

    of: _AnswerName
    least: Annotated[float | None, Quantity(PURE_NUMBER)] = None
    most: Annotated[float | None, Quantity(PURE_NUMBER)] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a limit that is none."""
        if self.least is None and self.most is None:
            yield Problem((), "least or most is needed, a number in the unit of the table")
        elif self.least is not None and self.most is not None and self.least > self.most:
            yield Problem(("least",), "must not be above most")

    def excess(self, value: float) -> float:
        """Return the excess of an answer over the limit, relative to it; 0 within."""
        below = 0.0 if self.least is None else self.least - value
        above = 0.0 if self.most is None else value - self.most
        bound = max(abs(one) for one in (self.least, self.most) if one is not None)
        return max(0.0, below, above) / (bound or 1.0)


class Optimise(Running):
    """A study that looks for the best numbers of a case.

    Attributes:
        goal: name of the answer, as in table.csv without its unit.
        direction: "least" or "most" of it.
        method: "differential-evolution": many runs at once, over all ranges; "nelder-mead": one
            after another, from the middle.
        runs: at most.
        seed: of the first method.
        limits: on answers.
        inputs: the numbers, with low and high.
    """

    goal: _AnswerName
    direction: Annotated[str, Choice((LEAST, MOST))] = LEAST
    method: Annotated[str, Choice((EVOLUTION, SIMPLEX))] = EVOLUTION
    runs: Annotated[int, Whole(4, 100_000)] = 60
    seed: Annotated[int, Whole(0, 2**31 - 1)] = 0
    limits: tuple[AnswerLimit, ...] = Field((), max_length=100)
    inputs: tuple[VariedInput, ...] = Field((), max_length=30)

    @property
    def population(self) -> int:
        """Runs of a generation of the first method."""
        return POPULATION * len(self.inputs) + 4

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield numbers that are missing, named twice or without a range, and too few runs."""
        if self.method == EVOLUTION and self.inputs and self.runs < self.population:
            text = f"at least {self.population}, those of one generation, are needed with"
            yield Problem(("runs",), f'{text} {len(self.inputs)} inputs; or method = "{SIMPLEX}"')
        if not self.inputs:
            yield Problem(("inputs",), "missing; at least one [[optimise.inputs]] is needed")
        for index, one in enumerate(self.inputs):
            if one.of in [other.of for other in self.inputs[:index]]:
                yield Problem(("inputs", index, "of"), "is varied already; leave one out")
            if one.distribution not in (UNIFORM, LOG_UNIFORM) or one.values is not None:
                text = f'needs low and high, and distribution = "{UNIFORM}" or "{LOG_UNIFORM}"'
                yield Problem(("inputs", index), text)
            if one.factor:
                yield Problem(("inputs", index, "factor"), "is for [vary]; give the number itself")
