"""Snapshot of a coupled problem after an accepted step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.fields.declaration import FieldPlace, OutputField
from castx.case.fields.registry import output_fields
from castx.coupling.step import CoupledProblem
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.equilibrium.problem import MechanicalProblem
from castx.errors import CaseError
from castx.process.ejection import normal_force
from castx.process.field_state import FieldState, PairsState
from castx.process.process import StageProblem
from castx.results.states.quantities import CELLWISE, FOLLOWED_IN_CELLS
from castx.results.states.snapshot import ProcessState
from castx.solvers.counters import StepCounters
from castx.transfer.pair_state import PairState

TENSORS = (
    "mechanical_strain",
    "viscoplastic_strain",
    *(name for name, field in output_fields().items() if field.components == 6),
)
START, NONE = ProcessState(), MappingProxyType[str, float]({})


@dataclass(frozen=True)
class State:
    """Fields of a coupled problem at its committed state, see `Snapshot`.

    Args:
        now: problem of the present stage.
        time: [s].
        step: number of the step.
        counters: of the step.
        process: stage, cycle and events.
        left: totals of bodies and interfaces that are gone.
        friction: coefficients of friction of the bodies whose ejection is estimated.
        errors: by the steps, by their column; none where the case has no tolerance.
    """

    now: StageProblem
    time: float
    step: int
    counters: StepCounters
    process: ProcessState = START
    left: Mapping[str, float] = NONE
    friction: Mapping[str, float] = NONE
    errors: Mapping[str, float] = NONE

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there."""
        return self.now.mesh

    @property
    def pairs(self) -> Mapping[str, NodePairs]:
        """Their node pairs by the name of the interface."""
        return self.now.pairs

    @property
    def problem(self) -> CoupledProblem:
        """Heat and mechanics."""
        return self.now.problem

    def nodal(self, body: str, name: str) -> FloatArray:
        """Return a nodal field with ghosts, shape (nodes,), displacement (nodes, gdim).

        Raises:
            CaseError: the field does not exist in this run.
        """
        field = _read_field(name, FieldPlace.NODE, f"no nodal field {name!r} on body {body!r}")
        if field.mechanical and body in self.now.rigid:
            return self._rigid_field(body, name)
        return field.values(FieldState(self.problem, body, name))

    def is_hindered(self, body: str) -> bool:
        """Return whether supports keep a body from shrinking evenly; rigid ones never shrink."""
        mechanics = self.problem.mechanics
        return mechanics is not None and mechanics.hindered.get(body, False)

    def cellwise(self, body: str, name: str) -> FloatArray:
        """Return a field constant in each cell, with ghosts, shape (cells,), tensors (cells, 6)."""
        if body in self.now.rigid and name in (*CELLWISE, *FOLLOWED_IN_CELLS):
            cells = len(self.mesh.bodies[body].nodes.dofmap.list)
            return np.zeros((cells, 6) if name in TENSORS else cells)
        state = FieldState(self.problem, body, name)
        if name == "mechanical_strain":
            return state.mechanics.mechanical_strain()
        if name == "viscoplastic_strain":
            return state.mechanics.viscoplastic_strain()
        if name == "coherent":
            return state.mechanics.coherent.astype(np.float64)
        field = _read_field(name, FieldPlace.CELL, f"no cell field {name!r} on body {body!r}")
        return field.values(state)

    def _rigid_field(self, body: str, name: str) -> FloatArray:
        """Return the displacement of a rigid body; it has no pressure, and no melt."""
        nodes = len(self.mesh.bodies[body].parent_vertices)
        if name == "displacement":
            within = self.time - self.process.cycle_start
            moved = self.now.rigid[body].displacement(within)
            return np.tile(moved, (nodes, 1))
        if name in ("pressure", "melt_suction"):
            return np.zeros(nodes)
        raise CaseError(f"no nodal field {name!r} on body {body!r}")

    def paired(self, interface: str, name: str) -> FloatArray:
        """Return a field of the owned pairs of an interface, shape (pairs,)."""
        field = _read_field(name, FieldPlace.PAIR, f"no field {name!r} on interface {interface!r}")
        return field.values(PairsState(self.problem, interface))

    @cached_property
    def totals(self) -> dict[str, float]:
        """Totals of bodies and interfaces by the name of their column, equal on all ranks.

        Raises:
            RuntimeError: the equilibrium of forces was freed, by which they are found.
        """
        if self.now.freed and self.problem.mechanics is not None:
            raise RuntimeError(
                f"the state at t = {self.time:g} s has no totals any more: its problem was freed "
                "by destroy(), or a new stage has begun; read them before the next step"
            )
        totals = self.problem.heat.totals()
        for name in self.problem.heat.solid_fraction:
            totals |= self._heat_totals(name)
        for interface, state in zip(
            self.problem.interfaces.described, self.problem.interfaces.states, strict=True
        ):
            totals |= self._interface_totals(interface.name, state)
        if self.problem.mechanics is not None:
            for name, body in self.problem.mechanics.bodies.items():
                of_liquid = body.liquid_totals() or {}
                totals |= {f"{name}.{key}": value for key, value in of_liquid.items()}
            totals |= self._balance_totals(self.problem.mechanics)
            totals |= self.problem.mechanics.clamp_totals()
        for name, coefficient in self.friction.items():
            if name in self.mesh.bodies:
                force = coefficient * normal_force(self.problem, name)
                totals[f"{name}.ejection_force"] = force
        if self.process.staged:
            totals |= {"cycle": self.process.cycle, "stage": self.process.stage}
        return {**self.left, **totals, **self.errors}

    def _balance_totals(self, mechanics: MechanicalProblem) -> dict[str, float]:
        axes = {"axisymmetric": " z", "3d": "xyz"}.get(self.mesh.model, "xy")
        about = "xyz" if self.mesh.model == "3d" else "z"
        shown = mechanics.equilibrium.shown
        found = {"support_force": shown.support_force(), "largest_pull": shown.largest_pull()}
        for name, error in shown.force_errors().items():
            found[f"{name}.force_error"] = error
        for name, (force, moment) in shown.supports().items():
            for axis, value in zip(axes, force, strict=True):
                # In an axisymmetric model nothing supports the radius.
                if axis != " ":
                    found[f"{name}.support_force.{axis}"] = float(value)
            for axis, value in zip(about, moment, strict=False):
                found[f"{name}.support_moment.{axis}"] = float(value)
        return found

    def _heat_totals(self, body: str) -> dict[str, float]:
        """Return the mean solid fraction of a body, and its temperatures; collective."""
        comm, volumes = self.mesh.comm, self.problem.volumes[body]
        solid = self.problem.heat.solid_fraction[body].x.array[: len(volumes)]
        hot = self.problem.heat.temperature[body].x.array[: len(volumes)]
        inside = self.problem.heat.solid_inside[body]()
        local = np.array([solid @ volumes + inside, hot @ volumes, volumes.sum()])
        solid_volume, heat, volume = comm.allreduce(local, op=MPI.SUM)
        return {
            f"{body}.solid_fraction": float(solid_volume / volume),
            f"{body}.min_temperature": comm.allreduce(float(hot.min(initial=np.inf)), op=MPI.MIN),
            f"{body}.mean_temperature": float(heat / volume),
            f"{body}.max_temperature": comm.allreduce(float(hot.max(initial=-np.inf)), op=MPI.MAX),
        }

    def _interface_totals(self, name: str, state: PairState) -> dict[str, float]:
        comm, pairs = self.mesh.comm, self.pairs[name]
        closed = state.closed | (state.gap <= 0)
        local = np.array([pairs.areas @ state.gap, pairs.areas @ closed, pairs.areas.sum()])
        gap, touching, area = comm.allreduce(local, op=MPI.SUM)
        total = comm.allreduce(state.force.sum(axis=0), op=MPI.SUM)
        axes = {"axisymmetric": "rz", "3d": "xyz"}.get(self.mesh.model, "xy")
        found = {
            f"{name}.mean_gap": float(gap / area),
            f"{name}.min_gap": float(comm.allreduce(state.gap.min(initial=np.inf), op=MPI.MIN)),
            f"{name}.max_gap": float(comm.allreduce(state.gap.max(initial=-np.inf), op=MPI.MAX)),
            f"{name}.closed_fraction": float(touching / area),
            f"{name}.suction": self._suction(name),
        }
        return found | {f"{name}.force.{a}": float(f) for a, f in zip(axes, total, strict=True)}

    def _suction(self, name: str) -> float:
        """Return the largest stress by which liquid at its wall is pulled [Pa]; collective."""
        largest = float(self.paired(name, "wall_suction").max(initial=0.0))
        return float(self.mesh.comm.allreduce(largest, op=MPI.MAX))


def _read_field(name: str, place: FieldPlace, refusal: str) -> OutputField:
    field = output_fields().get(name)
    if field is None or field.read is None or field.place is not place:
        raise CaseError(refusal)
    return field
