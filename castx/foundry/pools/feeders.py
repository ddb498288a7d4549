"""The feeders of all bodies that freeze: their levels and pipes through a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.fields.feeding import EMPTIED
from castx.foundry.pools.feeding_surfaces import FeedingNodes, FeedingSurfaces
from castx.foundry.pools.pipe import BodyPipe, PipedMetal
from castx.foundry.pools.pooled_metal import pooled_metals
from castx.foundry.porosity import melt_contraction
from castx.stateful import Arrays, Saved, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh


class FreezingState(Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def process(self) -> Any:
        """Bodies that are new."""

    @property
    def totals(self) -> Mapping[str, float]:
        """Totals by the name of their column in history.csv."""

    @property
    def mesh(self) -> CastingMesh:
        """The bodies that are there."""

    @property
    def pairs(self) -> Mapping[str, Any]:
        """The interfaces that are there."""

    def nodal(self, body: str, name: str, /) -> FloatArray:
        """Return a nodal field with ghosts."""


class Feeders:
    """The pipes of all bodies whose feeders sink.

    Args:
        mesh: of all bodies.
        metals: those bodies by name, and the nodes on their feeders.
    """

    def __init__(
        self, mesh: CastingMesh, metals: Mapping[str, tuple[PipedMetal, FeedingNodes]]
    ) -> None:
        self._feeding = {name: nodes for name, (_, nodes) in metals.items()}
        self._bodies = {
            name: BodyPipe(mesh.bodies[name], mesh.model, metal)
            for name, (metal, _) in metals.items()
        }

    def update(self, state: FreezingState) -> None:
        """Follow the pipes to the state after an accepted step; collective."""
        for name, pipe in self._bodies.items():
            if name not in state.mesh.bodies:
                continue
            if name in state.process.renewed:
                pipe.begin()
            feeders = self._feeding[name].by_feeder(list(state.pairs))
            supplied = {feeder: state.totals[f"{name}.fed_volume.{feeder}"] for feeder in feeders
                        if pipe.flows}  # fmt: skip
            pipe.update(state.nodal(name, "solid_fraction"), feeders, supplied)

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return the share of each node that has flowed out, (nodes,); None: not known here."""
        if name != EMPTIED or body not in self._bodies:
            return None
        return self._bodies[body].emptied

    def totals(self) -> dict[str, float]:
        """Return levels [m] and volumes of pipes [m³] by the name of their column; collective."""
        found = {}
        for name, pipe in self._bodies.items():
            found[f"{name}.pipe_volume"] = pipe.volume()
            for feeder, level in pipe.levels.items():
                found[f"{name}.feeder_level.{feeder}"] = level
        return found

    def described(self) -> dict[str, Any]:
        """Return the pipes for run.json; collective."""
        return {
            name: {
                "pipe_volume": pipe.volume(),
                "unfed_volume": pipe.unfed,
                "levels": {
                    feeder: level if np.isfinite(level) else None
                    for feeder, level in pipe.levels.items()
                },
            }
            for name, pipe in self._bodies.items()
        }

    def saved(self) -> dict[str, Saved]:
        """Return the pipes of all bodies; collective."""
        return saved_parts(self._bodies)

    def restore(self, arrays: Arrays) -> None:
        """Go on with the pipes of an earlier part; one that was not followed begins now."""
        for name, pipe in self._bodies.items():
            if part := part_of(arrays, name):
                pipe.restore(part)


def piped_metals(case: Case) -> dict[str, tuple[PipedMetal, FeedingSurfaces]]:
    """Return the bodies whose feeders sink: of metal that shrinks as it freezes, under gravity.

    Args:
        case: that has them.

    Returns:
        The metal of each, and the surfaces that feed it.
    """
    gravity = np.array(case.loads.gravity)
    metals = {}
    for name, metal in pooled_metals(case).items():
        if metal.shrinkage is None or metal.shrinkage <= 0.0 or not gravity.any():
            continue
        up = -gravity / np.linalg.norm(gravity)
        limit = 1.0 if metal.flows else case.foundry.mass_feeding_limit
        piped = PipedMetal(
            float(melt_contraction(np.asarray(metal.shrinkage))),
            metal.limit if limit is None else limit,
            tuple(up.tolist()),
            metal.surfaces.feeders,
            metal.flows,
        )
        metals[name] = piped, metal.surfaces
    return metals


def feeders_of(case: Case, mesh: CastingMesh) -> Feeders:
    """Return the feeders of a case."""
    metals = {
        name: (metal, FeedingNodes(mesh.bodies[name], mesh.model, surfaces))
        for name, (metal, surfaces) in piped_metals(case).items()
    }
    return Feeders(mesh, metals)
