"""When the stages of a process begin, cycle after cycle: pure numbers."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from castx.case.stages import Stage

SLACK = 1e-9
"""Part of a time by which it may miss another and still be the same."""


@dataclass(frozen=True)
class Phase:
    """One stage in one cycle.

    Attributes:
        start: time at which it begins [s].
        stage: its number; 0 is what the case describes without stages.
        cycle: its number, from 1.
        cycle_start: time at which the cycle begins [s]; tables over time count from there.
    """

    start: float
    stage: int
    cycle: int
    cycle_start: float


class Schedule:
    """All phases of a run, in their order.

    Attributes:
        phases: the phases.
        stages: number of different ones, the start included.
        cycles: how often they are gone through.
        cycle_length: from cycle to cycle [s].
        end: of the run [s].

    The last stage may ask for cycles. One that does nothing else marks the end of the cycle; behind
    one that acts, the cycle ends at the end of the case.

    Args:
        stages: of the case.
        end: of the case [s]: of the run, or where cycles go on longer of the first one.
    """

    def __init__(self, stages: Sequence[Stage], end: float) -> None:
        self.cycles = (stages[-1].repeat or 1) if stages else 1
        self.cycle_length = end
        starts = [0.0, *(stage.at for stage in stages)]
        if stages and not stages[-1].acts:
            self.cycle_length = starts.pop()
        self.stages = len(starts)
        whole = self.cycles * self.cycle_length
        cut = self.cycle_length * (1 + SLACK) < end < whole
        self.end = end if cut else whole
        self.phases = [
            Phase(cycle * self.cycle_length + start, stage, cycle + 1, cycle * self.cycle_length)
            for cycle in range(self.cycles)
            for stage, start in enumerate(starts)
            if cycle * self.cycle_length + start < self.end * (1 - SLACK)
        ]

    @property
    def stops(self) -> tuple[float, ...]:
        """Times at which a phase ends and the next one begins [s]."""
        return tuple(phase.start for phase in self.phases[1:])

    def number_at(self, time: float) -> int:
        """Return the number of the phase to which the step that begins at a time [s] belongs."""
        starts = [phase.start for phase in self.phases]
        return bisect_right(starts, time + SLACK * self.end) - 1
