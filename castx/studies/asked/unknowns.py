"""A number of the case, or a table, that is identified."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Annotated, Any

from pydantic import Field, PlainValidator

from castx.input.coordinates import AXES
from castx.input.entries import Choice, Description, EntryName, Quantity
from castx.input.problems import Problem
from castx.input.units import PURE_NUMBER
from castx.studies.asked.amounts import AMOUNT, Amount, amount, other_unit

LOG, LINEAR = "log", "linear"
OVER = ("time", "gap", "temperature", "pressure", *AXES)
LARGEST_DIFFERENCE = 1.0
"""Of a logarithm: a factor of e says nothing of a slope any more."""
_MOST_KNOTS = 100
_Amounts = Annotated[tuple[Annotated[Amount, AMOUNT], ...], Field(max_length=_MOST_KNOTS)]


def _start(value: Any) -> tuple[Amount, ...]:
    values = value if isinstance(value, list | tuple) else [value]
    return tuple(amount(one) for one in values)


class SoughtNumber(Description):
    """An unknown of `[identify]`.

    Attributes:
        of: its path in the case file, as `--set` takes it.
        name: in the report.
        over: of a table, the quantity of its first column, or the coordinate along which it goes.
        knots: of a table, where its values are unknown; between them it is linear, in ln with
            `scale = "log"`.
        start: value to begin with and known before, or of each knot; None: that of the case.
        scale: "log": its logarithm is identified; "linear": the number itself.
        deviation: how well it is known before, in ln or, linear, in its unit; None: nothing is.
        smoothness: γ, deviation of the second differences of a table; None: it may be rough.
        low: smallest value that is tried.
        high: largest one.
        difference: forward difference for its slope, in ln (0.01) or, linear, in its unit.
    """

    of: Annotated[str, Field(min_length=1, max_length=200)]
    name: EntryName
    over: Annotated[str | None, Choice(OVER)] = None
    knots: _Amounts | None = None
    start: Annotated[tuple[Amount, ...] | None, PlainValidator(_start)] = None
    scale: Annotated[str, Choice((LOG, LINEAR))] = LOG
    deviation: Annotated[float | None, Quantity(PURE_NUMBER, above=0.0)] = None
    smoothness: Annotated[float | None, Quantity(PURE_NUMBER, above=0.0)] = None
    low: Annotated[Amount | None, AMOUNT] = None
    high: Annotated[Amount | None, AMOUNT] = None
    difference: Annotated[float | None, Quantity(PURE_NUMBER, above=0.0)] = None

    @property
    def is_table(self) -> bool:
        """Whether it is a table."""
        return self.over is not None

    @property
    def given_unit(self) -> str | None:
        """Unit of its values; None: none is given, and that of the case counts."""
        given = (*(self.start or ()), self.low, self.high)
        return next((one.unit for one in given if one is not None), None)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield tables without knots, bounds that are none, and starts beyond them."""
        if self.is_table != (self.knots is not None):
            yield Problem((), "a table needs both over and knots, a number none of them")
            return
        yield from self._knot_problems()
        text = other_unit([*(self.start or ()), self.low, self.high])
        if text:
            yield Problem((), f"{self.name} {text}")
            return
        if self.low is not None and self.high is not None and self.low.value >= self.high.value:
            yield Problem(("low",), f"must lie below high = {self.high.value:g}; exchange them")
        for one in self.start or ():
            if self.low is not None and one.value <= self.low.value:
                yield Problem(("start",), f"must lie above low = {self.low.value:g}")
            if self.high is not None and one.value >= self.high.value:
                yield Problem(("start",), f"must lie below high = {self.high.value:g}")
        for key, given in (("low", self.low), ("high", self.high)):
            if self.scale == LOG and given is not None and given.value <= 0.0:
                yield Problem((key,), f'must be positive, or scale = "{LINEAR}"')
        yield from self._difference_problems()
        if self.scale == LOG and any(one.value <= 0.0 for one in self.start or ()):
            yield Problem(("start",), f'must be positive, or scale = "{LINEAR}"')

    def _difference_problems(self) -> Iterator[Problem]:
        """Yield a difference that is no small one."""
        if self.difference is None:
            return
        if self.scale == LOG and self.difference > LARGEST_DIFFERENCE:
            text = f"is one of ln: at most {LARGEST_DIFFERENCE:g}, of 1 % it is 0.01"
            yield Problem(("difference",), text)
        elif self.low is not None and self.high is not None:
            if self.scale == LINEAR and self.difference >= self.high.value - self.low.value:
                yield Problem(("difference",), "must be smaller than that of low and high")

    def _knot_problems(self) -> Iterator[Problem]:
        knots = self.knots or ()
        count = len(self.start or ())
        if self.is_table and len(knots) < 2:
            yield Problem(("knots",), "at least two are needed; one number is no table")
        if text := other_unit(knots):
            yield Problem(("knots",), text)
        values = [one.value for one in knots]
        if any(b <= a for a, b in pairwise(values)):
            yield Problem(("knots",), "must rise")
        if self.start is not None and count not in {1, max(len(knots), 1)}:
            several = f", or one for each of {len(knots)} knots" if knots else ""
            yield Problem(("start",), f"one number{several} is needed, there are {count}")
        if self.smoothness is not None and len(knots) < 3:
            yield Problem(("smoothness",), "needs a table of at least three knots")
