"""The process of a case: the problem of the present stage, and the changes of stage."""

from __future__ import annotations

import gc
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from castx.case.stages import SLACK, Phase, Schedule
from castx.contact.kinematics.rigid import RigidBody
from castx.coupling.step import CoupledProblem
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.process.cycles import CycleEnds
from castx.process.ejection import ejection_forces
from castx.process.events import Events
from castx.process.handover import handed_over, left_total, without
from castx.results.states.snapshot import ProcessState
from castx.stateful import Arrays, Saved, joined, part_of


@dataclass
class StageProblem:
    """The problem of one stage.

    Attributes:
        mesh: the bodies that are present.
        pairs: their node pairs by the name of the interface.
        problem: heat and mechanics.
        rigid: the rigid bodies by name.
        freed: the problem is no more.
    """

    mesh: CastingMesh
    pairs: Mapping[str, NodePairs]
    problem: CoupledProblem
    rigid: Mapping[str, RigidBody] = field(default_factory=dict)
    freed: bool = field(default=False, init=False)

    def destroy(self) -> None:
        """Free the PETSc objects of the problem; its states have no totals any more."""
        self.freed = True
        self.problem.destroy()


@dataclass(frozen=True)
class Cycling:
    """The cycles of a process.

    Attributes:
        ends: compares their ends.
        renewed: names of the bodies with which each of them begins anew.
        periodic: distance from the periodic state below which cycles are called periodic [K].
    """

    ends: CycleEnds
    renewed: Collection[str]
    periodic: float


class Process:
    """Goes through the stages of a case, cycle after cycle.

    Attributes:
        schedule: when stages begin.
        now: problem of the present one.
        left: totals of bodies and interfaces that are gone, by name.

    Args:
        schedule: when stages begin.
        build: returns the problem of a stage as if the run began with it; collective.
        ejected: for each stage the coefficients of friction of bodies that are drawn as it begins.
        cycling: None: there is one cycle.
    """

    def __init__(
        self,
        schedule: Schedule,
        build: Callable[[int], StageProblem],
        ejected: Sequence[Mapping[str, float]] = ({},),
        cycling: Cycling | None = None,
    ) -> None:
        self.schedule, self._build, self._cycling = schedule, build, cycling
        self._ejected = tuple(ejected)
        self.now = build(0)
        self.left: dict[str, float] = {}
        self._number = 0
        self._absent: dict[str, Saved] = {}
        self._renewed: frozenset[str] = frozenset()
        self._events = Events()

    @property
    def phase(self) -> Phase:
        """The present stage of the present cycle."""
        return self.schedule.phases[self._number]

    @property
    def friction(self) -> dict[str, float]:
        """Coefficients of friction of all bodies that are drawn, by their first stage."""
        found: dict[str, float] = {}
        for stage in self._ejected:
            found = {**stage, **found}
        return found

    def state(self) -> ProcessState:
        """Return stage, cycle and events for the results."""
        phase = self.phase
        return ProcessState(
            stage=phase.stage,
            cycle=phase.cycle,
            cycle_start=phase.cycle_start,
            cycles_ended=self._events.cycles_ended,
            renewed=self._renewed,
            events=tuple(self._events.known),
            staged=len(self.schedule.phases) > 1,
        )

    def proceed(self, time: float, totals: Callable[[], Mapping[str, float]]) -> bool:
        """Go to the stage of the step that begins at a time; return whether the stage changes.

        Args:
            time: committed time [s].
            totals: returns those of the committed state.
        """
        number = self.schedule.number_at(time)
        self._renewed = frozenset()
        if number == self._number:
            return False
        last, before = totals(), list(self.now.mesh.bodies)
        self.left = {name: left_total(name, value) for name, value in last.items()}
        known = {**self._absent, **self.now.problem.saved()}
        if self._cycling is not None and self.schedule.phases[number].cycle != self.phase.cycle:
            self._renewed = frozenset(self._cycling.renewed)
            known = without(known, self._renewed)
        drawn = self._ejected[self.schedule.phases[number].stage]
        forces = ejection_forces(self.now.problem, drawn)
        self._begin(number)
        self._take_over(known)
        here = list(self.now.mesh.bodies)
        removed = [name for name in before if name not in here]
        solid = {name: last.get(f"{name}.solid_fraction", 1.0) for name in (*here, *removed)}
        self._events.note_stage(
            time, self.phase, {name: solid[name] for name in here},
            removed={name: solid[name] for name in removed},
            renewed=sorted(self._renewed), forces=forces,
        )  # fmt: skip
        return True

    def _begin(self, number: int) -> None:
        self._number = number
        self.now.destroy()
        self.now = self._build(self.phase.stage)
        gc.collect()  # on all ranks at once: what is freed may be collective

    def _take_over(self, known: Mapping[str, Saved]) -> None:
        """Restore the known arrays in the new problem; keep those of absent bodies."""
        fresh, problem = self.now.problem.saved(), self.now.problem
        problem.restore({n: handed_over(known.get(n, saved), saved) for n, saved in fresh.items()})
        problem.begin_stage(self._renewed)
        self._absent = {name: saved for name, saved in known.items() if name not in fresh}

    def end_step(self, time: float) -> None:
        """Compare the cycle with the last one if it ends with the accepted step; collective."""
        following = self.schedule.phases[self._number + 1 : self._number + 2]
        end = following[0].start if following else self.schedule.end
        if self._cycling is None or abs(time - end) > SLACK * self.schedule.end:
            return
        self._cycling.ends.note(self.now.problem.heat.temperature)
        if following and following[0].cycle == self.phase.cycle:
            return
        if end < (self.phase.cycle_start + self.schedule.cycle_length) * (1 - SLACK):
            return  # the run ends in the middle of a cycle
        change = self._cycling.ends.change()
        self._events.note_cycle(time, self.phase.cycle, change, self._cycling.periodic)

    def notes(self) -> dict[str, Any]:
        """Return the stage and the events for the header of a checkpoint, as JSON knows them."""
        return {
            "phase": self._number,
            "start": self.phase.start,
            "left": self.left,
            "aside": sorted(self._absent),
            "events": self._events.known,
        }

    def prepare(self, notes: Mapping[str, Any]) -> None:
        """Go to the stage of `notes`, so that `saved` has the names of its arrays; collective.

        Raises:
            CaseError: the stages are at other times now.
        """
        number = int(notes["phase"])
        starts = [phase.start for phase in self.schedule.phases]
        if number >= len(starts) or starts[number] != notes["start"]:
            raise CaseError(
                f"the stages differ from those of the checkpoint (its stage began at "
                f"{notes['start']:g} s); undo the change of time.end, which ends the cycles, "
                "or run the case anew without --restart"
            )
        whole = self.now.problem.saved()
        self._number, self.left = number, dict(notes["left"])
        self._events.known = list(notes["events"])
        self._absent = {name: whole[name] for name in notes["aside"]}
        if self.phase.stage > 0:
            self._begin(self._number)

    def saved(self) -> dict[str, Saved]:
        """Return the committed state, absent bodies included; collective."""
        parts = {"problem": self.now.problem.saved(), "aside": self._absent}
        if self._cycling is not None:
            parts["cycle"] = self._cycling.ends.saved()
        return joined(parts)

    def restore(self, arrays: Arrays) -> None:
        """Restore a committed state; collective."""
        self.now.problem.restore(part_of(arrays, "problem"))
        aside = part_of(arrays, "aside")
        self._absent = {n: replace(s, values=aside[n]) for n, s in self._absent.items()}
        if self._cycling is not None:
            self._cycling.ends.restore(part_of(arrays, "cycle"))

    def destroy(self) -> None:
        """Free the PETSc objects."""
        self.now.destroy()
