"""Events of a process: stages that have begun and cycles that have ended."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from castx.case.stages import Phase
from castx.process.cycles import distance_from_periodic
from castx.results.states.snapshot import FULLY_SOLID

_log = logging.getLogger(__name__)


class Events:
    """The events of a run so far, each reported in its log as well.

    Attributes:
        known: the events in their order, as JSON knows them.
    """

    def __init__(self) -> None:
        self.known: list[dict[str, Any]] = []

    def note_stage(
        self,
        time: float,
        phase: Phase,
        bodies: Mapping[str, float],
        *,
        removed: Mapping[str, float],
        renewed: Sequence[str],
        forces: Mapping[str, Mapping[str, float]],
    ) -> None:
        """Note a stage that has begun.

        Args:
            time: when [s].
            phase: cycle and stage.
            bodies: that are there now, with the solid fractions that they had before.
            removed: solid fractions of the bodies that the stage removes.
            renewed: bodies that are new.
            forces: that draw bodies, see `ejection_forces`.
        """
        self.known.append(
            {
                "time": time,
                "cycle": phase.cycle,
                "stage": phase.stage,
                "bodies": list(bodies),
                "removed": dict(removed),
                "renewed": list(renewed),
                "ejection": forces,
            }
        )
        _log.info(
            "t = %g s: cycle %d, stage %d with %s",
            time, phase.cycle, phase.stage, ", ".join(bodies),
        )  # fmt: skip
        for body, fraction in bodies.items():
            if removed and body not in renewed and fraction < FULLY_SOLID:
                text = "%s is %.1f %% solid as %s leaves"
                _log.info(text, body, 100.0 * fraction, ", ".join(removed))
        for body, fraction in removed.items():
            if fraction < FULLY_SOLID:
                text = "%s is removed at t = %g s though only %.1f %% of it is solid"
                _log.warning(text, body, time, 100.0 * fraction)
        for body, found in forces.items():
            _log.info(
                "%s: about %.3g N to draw it, friction %g times normal forces of %.3g N (without "
                "draught and adhesion)",
                body, found["force"], found["friction"], found["normal"],
            )  # fmt: skip

    @property
    def cycles_ended(self) -> int:
        """Number of the cycles that have come to their end."""
        return sum("change" in event for event in self.known)

    def note_cycle(self, time: float, cycle: int, change: float | None, periodic: float) -> None:
        """Note the end of a cycle.

        Args:
            time: when [s].
            cycle: its number.
            change: largest change of a temperature since the cycle before [K]; None: unknown.
            periodic: distance from the periodic state below which cycles are called periodic [K].
        """
        earlier = [event["change"] for event in self.known if event.get("change") is not None]
        distance = distance_from_periodic([*earlier, change])
        is_periodic = distance is not None and max(distance, change or 0.0) <= periodic
        self.known.append(
            {
                "time": time,
                "cycle": cycle,
                "change": change,
                "distance": distance,
                "periodic": is_periodic,
            }
        )
        if change is not None:
            _log.info(
                "cycle %d ends within %.3g K of the one before%s: %s (%g K)",
                cycle,
                change,
                "" if distance is None else f", about {distance:.3g} K from the periodic state",
                "periodic" if is_periodic else "not periodic yet",
                periodic,
            )
