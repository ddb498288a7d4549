"""A number of the case that a study varies, and how it is spread."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated

from pydantic import Field
from scipy.stats import norm

from castx.input.entries import Choice, Description, EntryName, Whole
from castx.input.problems import Problem
from castx.studies.asked.amounts import AMOUNT, Amount, other_unit

UNIFORM, LOG_UNIFORM, NORMAL, LOG_NORMAL = "uniform", "log-uniform", "normal", "log-normal"
LOGARITHMIC = (LOG_UNIFORM, LOG_NORMAL)
_MOST_VALUES = 1000


class VariedInput(Description):
    """A number of the case with its range or distribution.

    Attributes:
        of: its path in the case file, as `--set` takes it.
        name: in tables; None: the path.
        low: smallest value.
        high: largest value.
        distribution: between them, or about `mean`.
        mean: of a normal distribution; of a log-normal one its median.
        deviation: of a normal distribution, in the unit of `mean`; of a log-normal one of ln.
        values: of a grid, in place of low, high and points.
        points: of a grid from low to high, even in the distribution.
        factor: whether its values multiply what the case has there, a number or a table.
    """

    of: Annotated[str, Field(min_length=1, max_length=200)]
    name: EntryName | None = None
    low: Annotated[Amount | None, AMOUNT] = None
    high: Annotated[Amount | None, AMOUNT] = None
    distribution: Annotated[str, Choice((UNIFORM, LOG_UNIFORM, NORMAL, LOG_NORMAL))] = UNIFORM
    mean: Annotated[Amount | None, AMOUNT] = None
    deviation: Annotated[Amount | None, AMOUNT] = None
    values: (
        Annotated[tuple[Annotated[Amount, AMOUNT], ...], Field(max_length=_MOST_VALUES)] | None
    ) = None
    points: Annotated[int, Whole(2, _MOST_VALUES)] = 3
    factor: bool = False

    @property
    def label(self) -> str:
        """Its name in tables."""
        return self.name or self.of

    @property
    def unit(self) -> str:
        """Unit of its values, "" if they are plain."""
        given = (*(self.values or ()), self.low, self.mean)
        return next((one.unit for one in given if one is not None), "")

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield ranges that are none, and distributions without what they need."""
        spread = self.deviation if self.distribution == NORMAL else None
        text = other_unit([*(self.values or ()), self.low, self.high, self.mean, spread])
        if text:
            yield Problem((), f"{self.of} {text}")
            return
        if self.values == ():
            yield Problem(("values",), "at least one is needed")
        if self.factor and self.unit:
            yield Problem(("factor",), f"multiplies: its values have no unit {self.unit!r}")
        if self.values is None:
            yield from self._spread_problems()
        if self.low is not None and self.high is not None and self.low.value >= self.high.value:
            yield Problem(("low",), "must lie below high; exchange them")
        if self.distribution in LOGARITHMIC:
            for key in ("low", "high", "mean"):
                given: Amount | None = getattr(self, key)
                if given is not None and given.value <= 0.0:
                    text = f'must be positive: its logarithm is spread; or use "{UNIFORM}"'
                    yield Problem((key,), text)

    def _spread_problems(self) -> Iterator[Problem]:
        bounded = self.distribution in (UNIFORM, LOG_UNIFORM)
        needed = ("low", "high") if bounded else ("mean", "deviation")
        for key in needed:
            if getattr(self, key) is None:
                text = (
                    f'missing; the distribution "{self.distribution}" needs {" and ".join(needed)}'
                    " where no database knows a range"
                )
                yield Problem((key,), text)
        if self.deviation is not None and self.deviation.value <= 0.0:
            yield Problem(("deviation",), "must be positive")
        elif not bounded and self.mean is not None and self.deviation is not None:
            yield from self._outside_problems()

    def _outside_problems(self) -> Iterator[Problem]:
        """Yield a mean so far outside low and high that nothing is left between them."""
        positive = [one for one in (self.low, self.mean, self.high) if one is not None]
        if self.distribution in LOGARITHMIC and any(one.value <= 0.0 for one in positive):
            return  # said as such
        if not all(math.isfinite(self.quantile(share)) for share in (0.0, 1.0)):
            text = "lies so far outside low and high that nothing of its spread is between them"
            yield Problem(("mean",), f"{text}; correct one of them")

    def quantile(self, share: float) -> float:
        """Return the value, in its unit, below which a share of all values lies.

        Normal distributions are cut at `low` and `high`, and at 0.1 and 99.9 % where those are not
        given, so that no run meets what is next to impossible.
        """
        if self.distribution in (UNIFORM, LOG_UNIFORM):
            assert self.low is not None and self.high is not None
            first, last = self._scaled(self.low.value), self._scaled(self.high.value)
            return self._unscaled(first + share * (last - first))
        assert self.mean is not None and self.deviation is not None
        middle, width = self._scaled(self.mean.value), self.deviation.value
        ends = (
            norm.cdf((self._scaled(end.value) - middle) / width) if end is not None else usual
            for end, usual in ((self.low, 0.001), (self.high, 0.999))
        )
        least, most = ends
        return self._unscaled(middle + width * float(norm.ppf(least + share * (most - least))))

    def _scaled(self, value: float) -> float:
        return math.log(value) if self.distribution in LOGARITHMIC else value

    def _unscaled(self, value: float) -> float:
        return math.exp(value) if self.distribution in LOGARITHMIC else value

    def level(self, share: float) -> float | str:
        """Return the value at a share as a case file writes it."""
        return Amount(0.0, self.unit).written(self.quantile(share))
