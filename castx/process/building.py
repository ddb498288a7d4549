"""Building of the process of a case from its stages."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from dataclasses import replace

from castx.case.case import Case
from castx.case.caveats import caveats
from castx.case.control import Time
from castx.case.skin import chosen_text
from castx.case.stages import Schedule
from castx.contact.kinematics.hidden_pairs import hidden_pair_warnings
from castx.coupling.building import (
    build_problem,
    check_clamps,
    check_surfaces,
    laws_above_solidus,
    rigid_bodies,
)
from castx.coupling.loose_parts import loose_parts
from castx.coupling.thin_walls import thin_walls
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.areas import area_text, area_warnings
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.heat.building import initial_state, run_accounts
from castx.input.problems import among
from castx.process.cycles import CycleEnds
from castx.process.load_corners import load_corners, stops_of
from castx.process.plausible import refuse_absurd_displacements
from castx.process.process import Cycling, Process, StageProblem
from castx.process.stage_case import stage_case
from castx.process.step_control import MOST_SUBSTEPS, ErrorBounds, StepSettings
from castx.transfer.conductance import ConductionLaw

SMALLEST = 1e-3
"""Share of the first step that is the smallest one, unless the case says it."""
SHORTEST = 1e-9
"""Least first step over the end of a run, below which the step control tells no two times apart."""

_log = logging.getLogger(__name__)


class StageBuilder:
    """Builds the problems of the stages of a case, on one mesh.

    Args:
        case: the case.
        mesh: of all its bodies.
        pairs: of all its interfaces, by name.
        laws: of the conduction through interfaces, in place of those of the case.

    Raises:
        CaseError: a stage cannot be run as described, or a law has no interface.
        MeshError: a surface is missing.
    """

    def __init__(
        self,
        case: Case,
        mesh: CastingMesh,
        pairs: Mapping[str, NodePairs],
        laws: Mapping[str, ConductionLaw],
    ) -> None:
        for name in laws:
            if name not in pairs:
                raise CaseError(f"a law for the interface {name!r}; {among(name, list(pairs))}")
        self._mesh, self._pairs, self._laws = mesh, pairs, laws
        self._cases = stage_cases(case, mesh)
        self._accounts = run_accounts(case, self._cases)
        # A file of temperatures is read once: it may be gone when a casting is renewed.
        self._temperatures = (
            None if case.coupling.scheme == "mechanical" else initial_state(case.bodies, mesh)
        )

    def __call__(self, number: int) -> StageProblem:
        """Return the problem of a stage as if the run began with it; collective."""
        case = self._cases[number]
        there = {body.name: self._mesh.bodies[body.name] for body in case.bodies}
        mesh = replace(self._mesh, bodies=there)
        pairs = {interface.name: self._pairs[interface.name] for interface in case.interfaces}
        laws = {name: law for name, law in self._laws.items() if name in pairs}
        problem = build_problem(case, mesh, pairs, laws, self._accounts, self._temperatures)
        return StageProblem(mesh, pairs, problem, rigid_bodies(case, mesh))


def stage_cases(case: Case, mesh: CastingMesh) -> list[Case]:
    """Return the cases of all stages, the start first.

    Args:
        case: the case.
        mesh: of all its bodies.

    Raises:
        CaseError: a stage cannot be run as described.
        MeshError: a surface is missing.
    """
    check_surfaces(case, mesh)
    surfaces = {name: tuple(body.surfaces) for name, body in mesh.bodies.items()}
    numbers = range(Schedule(case.stages, case.time.end).stages)
    found = [stage_case(case, number, surfaces) for number in numbers]
    for stage in found:
        rigid_bodies(stage, mesh)
        check_clamps(stage, mesh)
        refuse_absurd_displacements(stage, mesh)
    return found


def process_of(
    case: Case,
    mesh: CastingMesh,
    pairs: Mapping[str, NodePairs],
    laws: Mapping[str, ConductionLaw] | None = None,
) -> Process:
    """Return the process of a case at its start. Arguments and errors as in `StageBuilder`."""
    schedule = Schedule(case.stages, case.time.end)
    for line in laws_above_solidus(case, mesh):
        _log.info("%s", line)
    if chosen := chosen_text(case):
        _log.info("%s", chosen)
    for caveat in caveats(case):
        _log.warning("%s", caveat)
    for loose in loose_parts(case, mesh, pairs):
        _log.warning("%s", loose)
    for walls in thin_walls(case, mesh):
        _log.warning("%s", walls.text)
    for found in pairs.values():
        if found.primary_area is not None:
            _log.info("interface %s: %s", found.name, area_text(found, mesh.comm))
    for warning in area_warnings(case.interfaces, pairs, mesh.comm):
        _log.warning("%s", warning)
    for warning in hidden_pair_warnings(case.interfaces, pairs, case.rigid_bodies, mesh.comm):
        _log.warning("%s", warning)
    builder = StageBuilder(case, mesh, pairs, laws or {})
    ejected = [{}, *(stage.friction for stage in case.stages)]
    if schedule.cycles == 1:
        return Process(schedule, builder, ejected)
    last = case.stages[-1]
    kept = [body.name for body in case.bodies if body.name not in last.renew]
    cycling = Cycling(CycleEnds(mesh, kept), last.renew, last.periodic)
    return Process(schedule, builder, ejected, cycling)


def first_change(time: Time) -> float:
    """Return the temperature by which the fastest node may change in the first step [K]."""
    tolerance = None if time.tolerance is None else time.tolerance.temperature
    return min(time.temperature_change, tolerance or math.inf)


def step_settings(case: Case, fastest: float = math.inf) -> StepSettings:
    """Return the settings of the step control of a case; steps end at stages and corners of loads.

    Args:
        case: the case.
        fastest: time in which the fastest node changes by `first_change` at first [s]; a first
            step that the case does not give is no longer.
    """
    time, schedule = case.time, Schedule(case.stages, case.time.end)
    first = float(f"{max(min(time.usual_first_step, fastest), SHORTEST * schedule.end):.2g}")
    first = first if time.first_step is None else time.first_step
    smallest = SMALLEST * first if time.smallest_step is None else time.smallest_step
    corners = load_corners(case, schedule) if time.fixed_step is None else ()
    return StepSettings(
        schedule.end,
        first,
        time.largest_step,
        min(smallest, first),
        time.wanted("temperature_change"),
        time.fixed_step,
        stops_of(schedule.stops, corners, smallest),
        time.wanted("solid_fraction_change"),
        time.wanted("skin_change"),
        time.reject_above,
        _error_bounds(time),
    )


def _error_bounds(time: Time) -> ErrorBounds | None:
    if time.tolerance is None:
        return None
    given = time.tolerance.model_dump(exclude_none=True)
    # Without a tolerance of its own the mechanics follows each heat step.
    most = 1 if set(given) == {"temperature"} else MOST_SUBSTEPS
    substeps = most if isinstance(time.heat_substeps, str) else time.heat_substeps
    return ErrorBounds(**given, substeps=substeps)
