"""Declaration of a verification: an exact solution, the runs to compare with it, tolerances."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray

FINE = 321
"""Points of an exact curve."""
LEAST_FALL = 1.6
"""By which an error of first order has to fall when elements and steps are halved."""


@dataclass(frozen=True)
class Resolution:
    """Resolution of a run in space and time.

    Attributes:
        size: of the elements [m].
        step: [s]; 0 where the answer does not depend on time.
    """

    size: float
    step: float = 0.0


MESHLESS = (Resolution(1.0),)
"""Levels of functions of arrays, which divide nothing."""


@dataclass(frozen=True)
class Answer:
    """One number of a run beside the exact one.

    Attributes:
        name: what it is.
        computed: by the run, SI.
        exact: by the solution, SI.
        unit: of both.
        tolerance: what the error may be, as a share of `scale`.
        scale: of the error; 1 for an error in units of its own.
    """

    name: str
    computed: float
    exact: float
    unit: str
    tolerance: float
    scale: float

    @classmethod
    def relative(
        cls, name: str, computed: float, exact: float, unit: str, tolerance: float
    ) -> Answer:
        """Return an answer whose error is a share of the exact number."""
        return cls(name, float(computed), float(exact), unit, tolerance, abs(float(exact)))

    @classmethod
    def difference(
        cls, name: str, computed: float, unit: str, tolerance: float, scale: float = 1.0
    ) -> Answer:
        """Return an answer that is a difference itself, such as the largest one of a profile.

        Args:
            name: what differs.
            computed: the difference.
            unit: of the difference.
            tolerance: as a share of the scale.
            scale: 1 for a tolerance in the unit.
        """
        return cls(name, float(computed), 0.0, unit, tolerance, scale)

    @classmethod
    def rows(
        cls,
        name: str,
        values: Mapping[str, float],
        exact: Mapping[str, float],
        unit: str,
        tolerance: float,
    ) -> tuple[Answer, ...]:
        """Return answers with relative errors, one for each place or parameter.

        Args:
            name: of the quantity.
            values: computed ones by where they are.
            exact: by the same keys.
            unit: of both.
            tolerance: of each.
        """
        return tuple(
            cls.relative(f"{name}, {where}", values[where], exact[where], unit, tolerance)
            for where in exact
        )

    @property
    def error(self) -> float:
        """The error over the scale."""
        return abs(self.computed - self.exact) / self.scale


@dataclass(frozen=True)
class Curve:
    """A computed curve beside the exact one.

    Attributes:
        name: in the legend.
        x: abscissas of the run, shape (points,).
        computed: there.
        exact_x: abscissas of the solution, shape (others,).
        exact: there.
    """

    name: str
    x: FloatArray
    computed: FloatArray
    exact_x: FloatArray
    exact: FloatArray


def fine(low: float, high: float) -> FloatArray:
    """Return abscissas at which an exact curve is drawn, shape (points,)."""
    return np.linspace(low, high, FINE, dtype=np.float64)


@dataclass(frozen=True)
class Comparison:
    """Curves with a common abscissa.

    Attributes:
        abscissa: its label with unit.
        ordinate: its label with unit.
        curves: at least one.
    """

    abscissa: str
    ordinate: str
    curves: tuple[Curve, ...]


@dataclass(frozen=True)
class Outcome:
    """Answers of a run.

    Attributes:
        answers: beside the exact numbers.
        norm: the error that has to fall with elements and steps.
        comparison: of the run and the solution.
    """

    answers: tuple[Answer, ...]
    norm: float
    comparison: Comparison


@dataclass(frozen=True)
class Verification:
    """An exact solution and the runs that are compared with it.

    Attributes:
        number: such as "V1".
        title: in a line.
        formula: the solution, lines of text.
        source: author, year, place.
        run: solves the problem at a level; collective.
        levels: from coarse to fine; the tolerances are those of the last one.
        quick: levels of a short check, from coarse to fine.
        refined: what the levels refine; "nothing" where the run is exact on any mesh.
        norm: in words, what has to fall.
    """

    number: str
    title: str
    formula: str
    source: str
    run: Callable[[Resolution, MPI.Intracomm], Outcome]
    levels: tuple[Resolution, ...]
    quick: tuple[Resolution, ...]
    refined: Literal["size", "step", "nothing"] = "size"
    norm: str = ""

    def measure(self, level: Resolution) -> float:
        """Return the refined size of a level: step or cell [m or s]."""
        return level.step if self.refined == "step" else level.size

    def allowance(self, level: Resolution) -> float:
        """Return the factor on the tolerances at a level coarser than the finest one.

        Linear elements and implicit Euler steps are of first order at least, so that tolerances
        grow with the size.
        """
        return max(self.measure(level) / self.measure(self.levels[-1]), 1.0)
