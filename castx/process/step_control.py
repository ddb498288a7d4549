"""Step control: pure numbers, no solver.

A step that changes some node by more than the wanted temperature, or freezes more of some body or
of a skin at its wall than wanted, makes the next one smaller, by less larger, within bounds on
growth and size; many passes or iterations forbid growth. A step that failed or changed far too much
is halved. Errors beyond their tolerance do the same. Steps land on the end and on stops without
leaving a sliver: the rest up to the next of them is divided evenly once it is shorter than two
steps.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass

import numpy as np

from castx.coupling.change import StepChange, StepErrors
from castx.errors import ConvergenceError
from castx.stateful import Arrays, Saved, number

GROWTH, SHRINKAGE, CUT = 1.5, 0.5, 0.5
"""Bounds of the ratio of consecutive steps, and the share of a rejected one that is tried next."""

SAFETY = 0.9
"""Share of the wanted change at which the next step aims."""

SMALLEST_CUT = 0.1
"""Least share of a step whose errors are too large that is tried next."""

NOT_REJECTED = math.inf, math.inf
"""Step and excess of its errors before any was rejected."""

MOST_SUBSTEPS = 10
"""Most heat steps inside a step that nobody has asked for."""

LANDING = 1e-6
"""Excess of a step over the wanted size, relative, at which it still lands on a stop."""


@dataclass(frozen=True)
class ErrorBounds:
    """Allowed errors by the steps.

    Attributes:
        temperature: of temperatures [K].
        gap: of gaps [m].
        strain: of viscoplastic strains.
        substeps: heat steps into which a step may be divided for the sake of temperatures.
    """

    temperature: float = math.inf
    gap: float = math.inf
    strain: float = math.inf
    substeps: int = 1

    def share(self, errors: StepErrors, substeps: int) -> float:
        """Return the largest ratio of an error to what is allowed.

        Args:
            errors: of a step.
            substeps: heat steps into which the step is divided, in place of those it had.
        """
        return max(
            errors.temperature * errors.substeps / substeps / self.temperature,
            errors.gap / self.gap,
            errors.strain / self.strain,
        )


@dataclass(frozen=True)
class StepSettings:
    """Bounds, ends and wanted changes of the steps; times in s.

    Attributes:
        end: end of the run.
        first: first step.
        largest: largest step.
        smallest: a step that fails at this size ends the run.
        temperature_change: wanted change of the fastest node in a step [K].
        fixed: constant step, without adaptivity.
        stops: all steps land on these times, ascending.
        solid_fraction_change: wanted change of the mean solid fraction of any body in a step.
        skin_change: wanted mean change over any interface of the metal that bears at its wall.
        reject_above: multiple of a wanted change or of a tolerance above which a step is taken
            again; fixed ones are kept, and for a change those up to the first one.
        tolerance: of the errors by the steps; None: nobody asks for them.
    """

    end: float
    first: float
    largest: float
    smallest: float
    temperature_change: float
    fixed: float | None = None
    stops: tuple[float, ...] = ()
    solid_fraction_change: float = math.inf
    skin_change: float = math.inf
    reject_above: float = math.inf
    tolerance: ErrorBounds | None = None


class StepControl:
    """Adapts the size of the steps to the changes and failures of earlier ones.

    Args:
        settings: bounds and wanted changes.
    """

    def __init__(self, settings: StepSettings) -> None:
        self._settings = settings
        self._size = settings.first if settings.fixed is None else settings.fixed
        self._tolerance = 1e-9 * settings.end
        self._cutbacks = 0
        self._rejected = NOT_REJECTED

    def finished(self, time: float) -> bool:
        """Return whether a time is the end."""
        return time >= self._settings.end - self._tolerance

    def propose(self, time: float) -> float:
        """Return the step to try from a time [s]."""
        rest = self._following(time) - time
        parts = math.ceil(rest / self._size - LANDING)
        if self._settings.fixed is not None and self._cutbacks == 0:
            return min(self._size, rest)
        return rest if parts <= 1 else rest / 2 if parts == 2 else self._size

    def landed(self, time: float) -> float:
        """Return the end or stop that a time [s] is but for round-off, else the time."""
        near = self._following(time - 2 * self._tolerance)
        return near if abs(near - time) <= self._tolerance else time

    def restart(self) -> None:
        """Return to the first step after a sudden change."""
        if self._settings.fixed is None:
            self._size = min(self._size, self._settings.first)

    def _following(self, time: float) -> float:
        """Return the stop or the end after a time."""
        stops = self._settings.stops
        number = bisect_right(stops, time + self._tolerance)
        return stops[number] if number < len(stops) else self._settings.end

    def is_too_much(self, step: float, change: StepChange) -> bool:
        """Return whether a step will be taken again for its changes, whatever its errors.

        Args:
            step: its size [s].
            change: of the state, so far.
        """
        return self._settings.fixed is None and self._smaller_by_change(step, change) < step

    def exceeds(self, step: float, change: StepChange) -> bool:
        """Return whether a step changed so much that it is rejected, and cut it then.

        Args:
            step: its size [s].
            change: of the state.
        """
        smaller = min(self._smaller_by_change(step, change), self._smaller_by_errors(step, change))
        if self._settings.fixed is not None or smaller >= step:
            return False
        self._size = smaller
        self._cutbacks += 1
        return True

    def _smaller_by_change(self, step: float, change: StepChange) -> float:
        """Return the step to try because the state changed too much, else the step itself."""
        settings = self._settings
        smaller = max(CUT * step, settings.first)
        # A step that lands on a stop may be the first one but for this excess: it stays.
        small = step <= smaller * (1 + 2 * LANDING)
        return step if small or self._excess(change) <= settings.reject_above else smaller

    def _smaller_by_errors(self, step: float, change: StepChange) -> float:
        """Return the step to try because its errors are too large, else the step itself.

        What changes at once has an error that does not fall with the step: it is accepted.
        """
        settings, excess = self._settings, self._error(change, change.errors.substeps)
        last_step, last_excess = self._rejected
        self._rejected = step, excess
        sudden = excess > last_excess * 0.5 * (1.0 + step / last_step)
        if sudden or excess <= settings.reject_above:
            return step
        return max(step * max(min(CUT, SAFETY / excess), SMALLEST_CUT), settings.smallest)

    def _error(self, change: StepChange, substeps: int | None = None) -> float:
        """Return the largest ratio of an error to its tolerance, with so many heat steps."""
        tolerance = self._settings.tolerance
        if tolerance is None:
            return 0.0
        return tolerance.share(change.errors, tolerance.substeps if substeps is None else substeps)

    def _excess(self, change: StepChange) -> float:
        """Return the largest ratio of a change in a step to its wanted value."""
        settings = self._settings
        return max(
            change.temperature / settings.temperature_change,
            change.mean_solid_fraction / settings.solid_fraction_change,
            change.skin / settings.skin_change,
        )

    def accept(self, step: float, change: StepChange, easy: bool) -> None:
        """Adapt the next step to an accepted one.

        Args:
            step: its size [s].
            change: of the state.
            easy: whether it took few passes and iterations.
        """
        settings, recovering = self._settings, self._cutbacks > 0
        self._cutbacks, self._rejected = 0, NOT_REJECTED
        if settings.fixed is not None:
            self._size = min(GROWTH * self._size, settings.fixed) if recovering else settings.fixed
            return
        excess = max(self._excess(change), self._error(change))
        ratio = SAFETY / excess if excess > 0 else GROWTH
        ratio = min(max(ratio, SHRINKAGE), GROWTH if easy and not recovering else 1.0)
        # A step cut short by a stop says nothing against the size it was cut from.
        size = max(step * ratio, self._size) if step < self._size and ratio >= 1 else step * ratio
        self._size = min(max(size, settings.smallest), settings.largest)

    def saved(self) -> dict[str, Saved]:
        """Return the size of the next step, and what was cut since the last accepted one."""
        return {
            "size": number(self._size),
            "cutbacks": number(self._cutbacks),
            "rejected": Saved(np.array(self._rejected)),
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore size and cuts; new bounds of the settings apply at once."""
        settings = self._settings
        size = float(arrays["size"])
        if settings.fixed is None:
            size = min(max(size, settings.smallest), settings.largest)
        self._size, self._cutbacks = size, int(arrays["cutbacks"])
        step, excess = arrays["rejected"]
        self._rejected = float(step), float(excess)

    def reject(self, step: float, cause: ConvergenceError) -> None:
        """Cut the step after a failed try.

        Raises:
            ConvergenceError: the step is the smallest one already; chained to its cause.
        """
        smallest = self._settings.smallest
        if step <= smallest * (1 + 1e-9):
            raise ConvergenceError(
                f"no solution with the smallest step of {smallest:g} s (time.smallest_step); "
                f"last reason: {cause}"
            ) from cause
        self._size = max(CUT * step, smallest)
        self._cutbacks += 1
