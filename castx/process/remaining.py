"""Wall clock time that a run will still take, from its last steps.

While a casting freezes, its solid fraction grows by about as much in each step; afterwards steps
grow with the time, up to the largest one. Cycles take as long as those before.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

from castx.results.states.snapshot import Snapshot

REMEMBERED = 8
"""Steps from which the wall clock time of a step, and the growth of steps, are taken."""
FROZEN = 3
"""Steps from which the growth of the solid fraction is taken."""
BEGUN = 0.02
"""Solid fraction below which a casting that freezes says nothing of what is to come."""
COOLING_GROWTH = 1.2
"""Usual growth of the steps of a casting that is solid, as long as it has not shown its own."""
LARGEST_GROWTH = 1.5
"""Of a step, over the one before."""
MOST_STEPS = 100_000


@dataclass(frozen=True)
class _Step:
    end: float
    size: float
    wall: float
    solid: float


class Remaining:
    """Follows a run and estimates what is left.

    Args:
        end: of the run [s].
        largest: step [s].
    """

    def __init__(self, end: float, largest: float = math.inf) -> None:
        self._end, self._largest = end, largest
        self._steps: deque[_Step] = deque(maxlen=REMEMBERED)
        self._passed = self._wall = 0.0
        self._cycle = 1

    def note(self, snapshot: Snapshot, freezing: str | None) -> None:
        """Take over an accepted step.

        Args:
            snapshot: the state after it.
            freezing: column of the solid fraction of the casting that freezes; None: none does.
        """
        counters = snapshot.counters
        solid = 1.0 if freezing is None else snapshot.totals.get(freezing, 1.0)
        self.take(snapshot.time, counters.step, counters.wall, solid, snapshot.process.cycle)

    def take(self, end: float, size: float, wall: float, solid: float, cycle: int = 1) -> None:
        """Take over an accepted step by its numbers.

        Args:
            end: of the step [s].
            size: of the step [s].
            wall: wall clock time that it took [s].
            solid: solid fraction of the casting that freezes; 1: none does.
            cycle: to which it belongs.
        """
        self._steps.append(_Step(end, size, wall, solid))
        self._passed += size
        self._wall += wall
        self._cycle = cycle

    def wall(self) -> float | None:
        """Return the wall clock time left [s]; None: nothing can be said yet."""
        if not self._steps:
            return None
        if self._cycle > 1:
            return self._wall / self._passed * max(self._end - self._steps[-1].end, 0.0)
        steps = self._steps_left()
        mean = sum(step.wall for step in self._steps) / len(self._steps)
        return None if steps is None else steps * mean

    def _steps_left(self) -> int | None:
        last, freezing, solid_at = self._steps[-1], 0, self._steps[-1].end
        if last.solid < 1.0 - 1e-9:
            recent = list(self._steps)[-FROZEN - 1 :]
            gained = last.solid - (recent[0].solid if len(recent) > 1 else 0.0)
            each = gained / max(len(recent) - 1, 1)
            if last.solid < BEGUN or each <= 0.0:
                return None
            # A run may end before all is solid.
            within = max(self._end - last.end, 0.0) / last.size
            freezing = max(math.ceil(min((1.0 - last.solid) / each, within) - 1e-9), 0)
            solid_at += freezing * last.size
        return freezing + self._cooling_steps(max(self._end - solid_at, 0.0), last.size)

    def _cooling_steps(self, rest: float, size: float) -> int:
        """Return the steps over a time if they grow as since all is solid."""
        sizes = [step.size for step in self._steps if step.solid >= 1.0 - 1e-9]
        if sizes:  # a stage begins with small ones
            sizes = sizes[sizes.index(min(sizes)) :]
        growth = COOLING_GROWTH
        if len(sizes) >= FROZEN:
            growth = (sizes[-1] / sizes[0]) ** (1.0 / (len(sizes) - 1))
        growth, steps = min(max(growth, 1.0), LARGEST_GROWTH), 0
        while rest > 1e-9 * self._end and steps < MOST_STEPS:
            size = min(growth * size, self._largest)
            rest -= size
            steps += 1
        return steps
