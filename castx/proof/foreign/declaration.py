"""Declaration of a case that another program keeps as a test, and of its numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mpi4py import MPI


@dataclass(frozen=True)
class Number:
    """One number of a case, by all who know it.

    Attributes:
        name: what it is, with time and place.
        foreign: that the other program keeps, SI and °C; None: it keeps none.
        computed: by castx.
        exact: by the solution, or by the independent one that the case names.
        unit: of all.
        tolerance: what castx may be away from the exact number, as a share of `scale`.
        scale: of errors, in the unit.
    """

    name: str
    foreign: float | None
    computed: float
    exact: float
    unit: str
    tolerance: float
    scale: float

    @classmethod
    def relative(
        cls,
        name: str,
        foreign: float | None,
        computed: float,
        exact: float,
        unit: str,
        tolerance: float,
    ) -> Number:
        """Return a number whose errors are shares of the exact one."""
        return cls(name, foreign, float(computed), exact, unit, tolerance, abs(exact))

    @property
    def error(self) -> float:
        """Of castx, over the scale."""
        return abs(self.computed - self.exact) / self.scale

    @property
    def foreign_error(self) -> float | None:
        """Of the other program, over the scale."""
        return None if self.foreign is None else abs(self.foreign - self.exact) / self.scale

    @property
    def met(self) -> bool:
        """Whether castx is within the tolerance; what is no number is not."""
        return self.error <= self.tolerance


@dataclass(frozen=True)
class ForeignCase:
    """A case of another program.

    Attributes:
        number: such as "X1".
        title: in a line.
        program: whose case it is.
        path: of its files in the repository of the program, or its number in the documentation.
        exact: where the exact numbers come from.
        remark: in a sentence, where the program, castx and the solution differ and why.
        run: solves it and returns its numbers; collective.
    """

    number: str
    title: str
    program: str
    path: str
    exact: str
    remark: str
    run: Callable[[MPI.Intracomm], tuple[Number, ...]]
