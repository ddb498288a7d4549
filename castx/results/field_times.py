"""Moments at which fields are written: given times, and events of the first cycle.

Events are when the first casting is solid by a quarter, a half, three quarters, 95 % and all of it,
and the first gap. By 95 % the liquid that is left shows where the casting freezes last.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from castx.results.states.snapshot import FULLY_SOLID

if TYPE_CHECKING:
    from castx.results.states.snapshot import Snapshot

FRACTIONS = {
    0.25: "25 % solid", 0.5: "50 % solid", 0.75: "75 % solid", 0.95: "95 % solid",
    FULLY_SOLID: "all solid",
}  # fmt: skip
"""Mean solid fractions of a casting that are events, with their names."""
OPEN = 1e-6
"""Gap from which an air gap counts [m]."""
FIRST_GAP = "first air gap"


def crossing(time: Sequence[float], fraction: Sequence[float], wanted: float) -> float:
    """Return when a solid fraction was reached within a step, all solid only at its end [s].

    Args:
        time: start and end of the step [s].
        fraction: the solid fractions then.
        wanted: the solid fraction between them.
    """
    if wanted >= FULLY_SOLID:
        return time[1]
    share = (wanted - fraction[0]) / (fraction[1] - fraction[0])
    return time[0] + share * (time[1] - time[0])


class FieldTimes:
    """Follows a run and tells the moments of each step whose fields are written.

    Args:
        every: time between given moments [s]; None: there are none.
        castings: the bodies that melt; the first of them that is not solid at first is followed.
    """

    def __init__(self, every: float | None, castings: Sequence[str]) -> None:
        self._every, self._castings = every, tuple(castings)
        self._followed: str | None = None
        self._time = 0.0
        self._phase: tuple[int, int] | None = None
        self._fraction = 0.0
        self._reached: set[str] = set()

    def begin(self, snapshot: Snapshot) -> None:
        """Take the initial state, or the one from which a run goes on: what it has is no event."""
        totals = snapshot.totals
        if self._followed is None:
            fractions = ((name, totals.get(f"{name}.solid_fraction")) for name in self._castings)
            liquid = [name for name, found in fractions if found is not None and found < 1 - 1e-9]
            self._followed = liquid[0] if liquid else None
        self._note(snapshot)
        self._reached |= {FRACTIONS[wanted] for wanted in FRACTIONS if wanted <= self._fraction}

    def within(self, snapshot: Snapshot) -> list[float]:
        """Return the moments of the step that ends with a state, ascending [s].

        The first step of a stage has its end alone, with which its bodies are known.
        """
        start, end, fraction = self._time, snapshot.time, self._fraction
        whole = self._phase == _phase(snapshot)
        self._note(snapshot)
        found = [*self._given(start, end), *self._events(snapshot, start, fraction)]
        near = 1e-9 * (end - start)
        inside = {end if end - time <= near else time for time in found}
        return sorted(inside if whole else {end for _ in inside})

    def _given(self, start: float, end: float) -> list[float]:
        if self._every is None:
            return []
        first = math.floor(start / self._every + 1e-9) + 1
        last = math.floor(end / self._every + 1e-9)
        return [number * self._every for number in range(first, last + 1)]

    def _events(self, snapshot: Snapshot, start: float, before: float) -> list[float]:
        if snapshot.process.cycle > 1:
            return []
        found, step = [], (start, snapshot.time)
        for wanted, name in FRACTIONS.items():
            if name not in self._reached and before < wanted <= self._fraction:
                found.append(crossing(step, (before, self._fraction), wanted))
                self._reached.add(name)
        if FIRST_GAP not in self._reached and is_open(snapshot.totals):
            found.append(snapshot.time)
            self._reached.add(FIRST_GAP)
        return found

    def _note(self, snapshot: Snapshot) -> None:
        self._time, self._phase = snapshot.time, _phase(snapshot)
        if self._followed is not None:
            name = f"{self._followed}.solid_fraction"
            self._fraction = float(snapshot.totals.get(name, self._fraction))

    def notes(self) -> dict[str, object]:
        """Return the followed casting and the events that have been, for JSON."""
        return {"casting": self._followed, "reached": sorted(self._reached)}

    def resume(self, notes: Mapping[str, object], snapshot: Snapshot) -> None:
        """Go on from a state whose run had these notes."""
        casting, reached = notes["casting"], notes["reached"]
        self._followed = None if casting is None else str(casting)
        self._reached = set(reached) if isinstance(reached, list) else set()
        self.begin(snapshot)


def is_open(totals: Mapping[str, float]) -> bool:
    """Return whether an interface of a run has an air gap."""
    return any(gap > OPEN for name, gap in totals.items() if name.endswith(".max_gap"))


def _phase(snapshot: Snapshot) -> tuple[int, int]:
    return snapshot.process.cycle, snapshot.process.stage
