"""The surfaces of a body through which liquid can follow, and their nodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from dolfinx import fem

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.case.bodies import Body
from castx.case.case import Case
from castx.domain.measures import nodal_sum
from castx.mechanics.liquid.feeding_paths import free_facets

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh


FREE = "free"
"""Name of the feeder that all free surfaces are together."""


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

    @property
    def feeders(self) -> tuple[str, ...]:
        """Names of the feeders: of the surfaces that the user names, or one for all free ones."""
        return (FREE,) if self.named is None else self.named

    def closed(self, present: Sequence[str]) -> frozenset[str]:
        """Return the surfaces that are not free while some interfaces are present."""
        facing = (self.facing[name] for name in present if name in self.facing)
        return frozenset({*self.shut, *facing})


class FeedingNodes:
    """The nodes of a body on surfaces through which liquid can follow, while they are free.

    Args:
        body: its mesh.
        model: geometric model.
        surfaces: of the body.
    """

    def __init__(self, body: BodyMesh, model: str, surfaces: FeedingSurfaces) -> None:
        self._body, self._model, self._surfaces = body, model, surfaces
        self._found: dict[frozenset[str], dict[str, BoolArray]] = {}

    def by_feeder(self, present: Sequence[str]) -> dict[str, BoolArray]:
        """Return whether nodes lie on each feeder, ghosts included, (nodes,); collective.

        Args:
            present: names of the interfaces that are there.
        """
        closed = self._surfaces.closed(present)
        if closed not in self._found:
            self._found[closed] = feeding_nodes(self._body, self._model, self._surfaces, closed)
        return self._found[closed]

    def any(self, present: Sequence[str]) -> BoolArray:
        """Return whether nodes lie on a surface that feeds, argument as above; collective."""
        found = np.zeros(len(self._body.parent_vertices), dtype=bool)
        for nodes in self.by_feeder(present).values():
            found |= nodes
        return found


def feeding_nodes(
    body: BodyMesh, model: str, surfaces: FeedingSurfaces, closed: frozenset[str]
) -> dict[str, BoolArray]:
    """Return whether nodes lie on each feeder, ghosts included, (nodes,); collective.

    All free surfaces together are one feeder where none is named.

    Args:
        body: the body.
        model: geometric model.
        surfaces: its surfaces.
        closed: those that are not free.
    """
    marked: FloatArray = np.zeros(len(body.parent_vertices))
    if surfaces.named is not None:
        found: dict[str, BoolArray] = {}
        for name in surfaces.named:
            found[name] = np.zeros(len(marked), dtype=bool)
            found[name][body.surface_nodes(name)] = True
        return found
    facets = open_facets(body, model, closed)
    marked[fem.locate_dofs_topological(body.nodes, body.mesh.topology.dim - 1, facets)] = 1.0
    return {FREE: np.asarray(nodal_sum(body, marked) > 0.0)}


def open_facets(body: BodyMesh, model: str, closed: frozenset[str]) -> IntArray:
    """Return the owned facets through which liquid can follow where no feeder is named.

    Args:
        body: the body.
        model: geometric model.
        closed: surfaces that are not free.
    """
    shut = {*body.symmetry_planes, *closed.intersection(body.surfaces)}
    return free_facets(body, model, sorted(shut))


def feeding_surfaces(case: Case, body: Body, named: bool = True) -> FeedingSurfaces:
    """Return the surfaces of a body through which liquid can follow.

    Args:
        case: that has the body.
        body: the body.
        named: whether surfaces that the case names are all that feed; else all free ones do.
    """
    if named and case.foundry.feeders is not None:
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
