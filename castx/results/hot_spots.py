"""Hot spots: the isolated pools of liquid of all bodies that freeze, ranked, and their table."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray
from castx.case.bodies import Body
from castx.case.case import Case
from castx.domain.measures import nodal_sum
from castx.foundry.alloy import missing
from castx.materials.lookup import find_material
from castx.mechanics.liquid.feeding_paths import free_facets
from castx.results.pools.pool import HotSpot, hot_spot, ranked
from castx.results.pools.tracking import BodyPools
from castx.results.quantities import parts
from castx.results.snapshot import Snapshot
from castx.stateful import Arrays, Saved, joined, part_of

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh

POOL = "pool"
"""Name of the field of pools."""
USUAL_LIMIT = 0.7
"""Solid fraction below which liquid flows in mass, where neither the user nor a coherency says; a
representative value."""


@dataclass(frozen=True)
class FeedingSurfaces:
    """The surfaces of a body through which liquid can follow.

    Attributes:
        named: those that the user names; None: all that are free.
        shut: surfaces that are never free, since they are held; planes of symmetry are not either.
        facing: the surface on each interface of the body, by the name of the interface.
    """

    named: tuple[str, ...] | None = None
    shut: tuple[str, ...] = ()
    facing: Mapping[str, str] = field(default_factory=dict)

    def closed(self, present: Sequence[str]) -> frozenset[str]:
        """Return the surfaces that are not free while some interfaces are present."""
        facing = (self.facing[name] for name in present if name in self.facing)
        return frozenset({*self.shut, *facing})


@dataclass(frozen=True)
class PooledMetal:
    """A body that freezes, as its pools see it.

    Attributes:
        limit: solid fraction below which a node belongs to a pool.
        shrinkage: s = (ρ_s - ρ_l)/ρ_s; None: the material does not say.
        surfaces: that feed.
    """

    limit: float
    shrinkage: float | None = None
    surfaces: FeedingSurfaces = FeedingSurfaces()


class HotSpots:
    """The pools of all bodies that freeze, and those that are isolated as hot spots.

    Args:
        mesh: the bodies.
        metals: those that freeze, by name.
    """

    def __init__(self, mesh: CastingMesh, metals: Mapping[str, PooledMetal]) -> None:
        self._model, self._metals = mesh.model, metals
        self._bodies = {
            name: BodyPools(mesh.bodies[name], mesh.model, metal.limit)
            for name, metal in metals.items()
        }
        self._feeding: dict[tuple[str, frozenset[str]], BoolArray] = {}

    def update(self, snapshot: Snapshot) -> None:
        """Follow the pools to the state after an accepted step; collective."""
        for name, pools in self._bodies.items():
            if name not in snapshot.mesh.bodies:
                continue
            if name in snapshot.process.renewed:
                pools.begin()
            feeds = self._feeds(snapshot.mesh.bodies[name], list(snapshot.pairs))
            pools.update(snapshot.time, snapshot.nodal(name, "solid_fraction"), feeds)

    def _feeds(self, body: BodyMesh, interfaces: Sequence[str]) -> BoolArray:
        """Return whether the nodes lie on a surface that feeds, (nodes,); collective."""
        surfaces = self._metals[body.name].surfaces
        closed = surfaces.closed(interfaces)
        if (body.name, closed) not in self._feeding:
            self._feeding[body.name, closed] = feeding_nodes(body, self._model, surfaces, closed)
        return self._feeding[body.name, closed]

    def numbers(self, body: str) -> FloatArray | None:
        """Return the pool of each local node of a body, not a number outside; None: it has none."""
        if body not in self._bodies:
            return None
        numbers = self._bodies[body].numbers
        return np.where(numbers > 0, numbers, np.nan)

    @property
    def ranked(self) -> list[HotSpot]:
        """The isolated pools of all bodies, the worst first; equal on all ranks."""
        return ranked(
            [
                hot_spot(name, pool, self._metals[name].shrinkage)
                for name, pools in self._bodies.items()
                for pool in pools.known
                if pool.isolation is not None
            ]
        )

    def described(self) -> list[dict[str, Any]]:
        """Return the hot spots for run.json, the worst first."""
        return [describe(spot) for spot in self.ranked]

    def table(self) -> str:
        """Return the hot spots as text of a CSV file, the worst first."""
        file = io.StringIO()
        writer = csv.writer(file, lineterminator="\n")
        axes = parts("displacement", self._model)
        writer.writerow(
            ["rank", "body", "pool", "parent", "children", "merged", "isolated", "ended",
             *(f"last.{axis}" for axis in axes), *(f"centre.{axis}" for axis in axes),
             "volume", "deficit"]
        )  # fmt: skip
        for rank, spot in enumerate(self.described(), 1):
            numbers = (" ".join(map(str, spot[name])) for name in ("children", "merged"))
            times = spot["isolated"], spot["ended"]
            places = *spot["place"], *spot["centre"]
            row = [rank, spot["body"], spot["pool"], spot["parent"], *numbers, *times, *places,
                   spot["volume"], spot["deficit"]]  # fmt: skip
            writer.writerow(["" if value is None else value for value in row])
        return file.getvalue()

    def saved(self) -> dict[str, Saved]:
        """Return the state of all bodies; collective."""
        return joined({name: pools.saved() for name, pools in self._bodies.items()})

    def notes(self) -> dict[str, Any]:
        """Return the records of all bodies, as JSON knows them."""
        return {name: pools.notes() for name, pools in self._bodies.items()}

    def restore(self, arrays: Arrays, notes: Mapping[str, Any]) -> None:
        """Go on with the pools of an earlier part; a body that was not followed begins now."""
        for name, pools in self._bodies.items():
            if (part := part_of(arrays, name)) and name in notes:
                pools.restore(part, notes[name])


def describe(spot: HotSpot) -> dict[str, Any]:
    """Return a hot spot as JSON knows it."""
    pool, isolation = spot.pool, spot.pool.isolation
    assert isolation is not None
    return {
        "body": spot.body,
        "pool": pool.number,
        "parent": pool.parent,
        "children": list(pool.children),
        "merged": list(pool.merged),
        "isolated": isolation.time,
        "ended": pool.ended,
        "place": list(pool.place),
        "centre": list(isolation.centre),
        "volume": isolation.volume,
        "deficit": spot.deficit,
    }


def feeding_nodes(
    body: BodyMesh, model: str, surfaces: FeedingSurfaces, closed: frozenset[str]
) -> BoolArray:
    """Return whether nodes lie on a surface that feeds, ghosts included, (nodes,); collective.

    Args:
        body: the body.
        model: geometric model.
        surfaces: its surfaces.
        closed: those that are not free.
    """
    marked: FloatArray = np.zeros(len(body.parent_vertices))
    if surfaces.named is not None:
        for name in surfaces.named:
            marked[body.surface_nodes(name)] = 1.0
        return marked > 0.0
    shut = {*body.symmetry_planes, *closed.intersection(body.surfaces)}
    facets = free_facets(body, model, sorted(shut))
    marked[fem.locate_dofs_topological(body.nodes, body.mesh.topology.dim - 1, facets)] = 1.0
    return np.asarray(nodal_sum(body, marked) > 0.0)


def pooled_metals(case: Case) -> dict[str, PooledMetal]:
    """Return the bodies of a case that freeze, as their pools see them, by name."""
    found = {}
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        if not material.melts or body.starts_solid(material.description):
            continue
        limit = case.foundry.pool_limit
        if limit is None:
            limit = USUAL_LIMIT if material.liquid is None else material.liquid.coherency
        key = "solidification_shrinkage"
        known = not missing(material.description, (key,))
        shrinkage = material.description.solidification_shrinkage if known else None
        found[body.name] = PooledMetal(limit, shrinkage, feeding_surfaces(case, body))
    return found


def feeding_surfaces(case: Case, body: Body) -> FeedingSurfaces:
    """Return the surfaces of a body through which liquid can follow."""
    if case.foundry.feeders is not None:
        pairs = (on.split("/") for on in case.foundry.feeders)
        return FeedingSurfaces(tuple(surface for name, surface in pairs if name == body.name))
    facing = {}
    for interface in case.interfaces:
        sides = interface.contact.pairing_rule.surfaces or interface.bodies[::-1]
        if body.name in interface.bodies:
            facing[interface.name] = sides[interface.bodies.index(body.name)]
    return FeedingSurfaces(None, tuple(_held(case, body.name)), facing)


def _held(case: Case, body: str) -> Iterator[str]:
    """Yield the surfaces of a body whose displacement is given."""
    for boundary in case.boundaries:
        if boundary.body == body and any(d.value is not None for d in boundary.displacement):
            yield boundary.surface
