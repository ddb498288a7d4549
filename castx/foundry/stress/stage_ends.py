"""Stress and distortion of the bodies at the ends of the stages of a run."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.discretisation.cell_errors import CellErrors
from castx.foundry.pools.feeding_surfaces import FeedingSurfaces
from castx.foundry.stress.fed_surface import fed_facets
from castx.foundry.stress.shape import Shape
from castx.foundry.stress.stresses import StressExtremes
from castx.foundry.stress.surface_forms import SurfaceForms

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh

NOT_FED = MappingProxyType[str, FeedingSurfaces]({})


class SolidState(Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def time(self) -> float:
        """End of the step [s]."""

    @property
    def process(self) -> Any:
        """Stage and cycle."""

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there."""

    def is_hindered(self, body: str, /) -> bool:
        """Return whether supports keep a body from shrinking evenly."""

    def nodal(self, body: str, name: str, /) -> FloatArray:
        """Return a nodal field with ghosts."""

    def cellwise(self, body: str, name: str, /) -> FloatArray:
        """Return a field constant in each cell, with ghosts."""


@dataclass(frozen=True, eq=False)
class SolidCopies:
    """Copies of stresses and displacements of one moment by body.

    Attributes:
        time: [s].
        cycle: number of the cycle.
        stage: number of the stage.
        stress: of the local cells, (cells, 6) [Pa].
        coherent: whether they are solid, (cells,).
        displacement: of the local nodes, (nodes, gdim) [m].
        hottest: highest temperature on this rank, not a number in a run without heat [°C].
        hindered: whether supports keep a body from shrinking evenly.
    """

    time: float
    cycle: int
    stage: int
    stress: Mapping[str, FloatArray]
    coherent: Mapping[str, BoolArray]
    displacement: Mapping[str, FloatArray]
    hottest: Mapping[str, float]
    hindered: Mapping[str, bool]


class StageEnds:
    """Keeps the last state, and describes it where a stage or the run ends.

    In cycles the last end of each stage counts.

    Args:
        mesh: of all bodies.
        bodies: names of those that deform.
        forms: of selected surfaces; None: none is.
        heated: whether the run knows temperatures.
        fed: surfaces through which bodies are fed, by body, which are no part of their shapes.
    """

    def __init__(
        self,
        mesh: CastingMesh,
        bodies: Collection[str],
        forms: SurfaceForms | None = None,
        heated: bool = True,
        fed: Mapping[str, FeedingSurfaces] = NOT_FED,
    ) -> None:
        self._forms, self._heated, self._comm = forms, heated, mesh.comm
        self._mesh = mesh
        there = {name: mesh.bodies[name] for name in bodies}
        self._owned = {
            name: body.mesh.topology.index_map(body.mesh.topology.dim).size_local
            for name, body in there.items()
        }
        self._stresses = {n: StressExtremes(body, mesh.model) for n, body in there.items()}
        self._shapes = {
            name: Shape(
                body,
                mesh.model,
                fed_facets(body, mesh.model, fed[name]) if name in fed else None,
            )
            for name, body in there.items()
        }
        self._found: dict[int, dict[str, Any]] = {}
        self._last: SolidCopies | None = None

    def update(self, state: SolidState) -> None:
        """Take over the state after an accepted step; collective."""
        last, process = self._last, state.process
        if last is not None and (last.cycle, last.stage) != (process.cycle, process.stage):
            self.described()
        names = [name for name in self._owned if name in state.mesh.bodies]
        self._last = SolidCopies(
            state.time,
            process.cycle,
            process.stage,
            {name: state.cellwise(name, "stress").copy() for name in names},
            {name: state.cellwise(name, "coherent") > 0.0 for name in names},
            {name: state.nodal(name, "displacement").copy() for name in names},
            {name: self._hottest(state, name) for name in names},
            {name: state.is_hindered(name) for name in names},
        )

    def _hottest(self, state: SolidState, name: str) -> float:
        temperature = state.nodal(name, "temperature") if self._heated else np.array([np.nan])
        return float(temperature.max(initial=-np.inf))

    def described(self) -> list[dict[str, Any]]:
        """Return the ends of the stages so far, the last state included, as JSON; collective."""
        last = self._last
        if last is not None and last.time != self._found.get(last.stage, {}).get("time"):
            self._found[last.stage] = {
                "stage": last.stage,
                "cycle": last.cycle,
                "time": last.time,
                "bodies": {name: self._body(name, last) for name in last.stress},
            }
        return [self._found[stage] for stage in sorted(self._found)]

    def _body(self, name: str, last: SolidCopies) -> dict[str, Any]:
        stress, displacement = last.stress[name], last.displacement[name]
        found: dict[str, Any] = {"stress": self._stresses[name].of(stress[: self._owned[name]])}
        found["hindered"] = last.hindered[name]
        errors = CellErrors(self._mesh.bodies[name], self._mesh.model, last.coherent[name])
        if error := errors.described(stress):
            found["stress_error"] = error
        if self._heated:
            found["hottest"] = self._comm.allreduce(last.hottest[name], op=MPI.MAX)
        if self._shapes[name].known:
            found["distortion"] = self._shapes[name].of(displacement)
        return found if self._forms is None else found | self._forms.of(name, displacement)

    def deviation(self, body: str) -> FloatArray | None:
        """Return the deviation in the last state at the local nodes [m], (nodes,); collective.

        Not a number off the surface; None: the body does not deform, or has nothing to compare.
        """
        if self._last is None or body not in self._last.displacement:
            return None
        if not self._shapes[body].known:
            return None
        return self._shapes[body].nodal_deviation(self._last.displacement[body])

    def resume(self, found: Sequence[Mapping[str, Any]]) -> None:
        """Go on behind the ends that an earlier part of the run has described."""
        self._found = {int(end["stage"]): dict(end) for end in found}
