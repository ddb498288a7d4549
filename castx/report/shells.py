"""Visible surfaces of bodies: their outer facets, by the names of surfaces and interfaces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.domain.cell_kinds import KINDS, CellKind
from castx.domain.mesh import BodyMesh, CastingMesh


@dataclass(frozen=True)
class Shell:
    """Visible surface of a body.

    Attributes:
        body: its name.
        filled: what is painted in the colour of the body: its outer facets, in plane models its
            cells, (polygons, corners, 3) [m].
        skins: outer facets by name, "body/surface" or that of an interface; corners in an order
            that goes round, (facets, corners, 3) [m].
    """

    body: str
    filled: FloatArray
    skins: dict[str, FloatArray]

    @property
    def points(self) -> FloatArray:
        """All corners (corners, 3) [m]."""
        return self.filled.reshape(-1, 3)


def shells_of(mesh: CastingMesh, interfaces: Sequence[str]) -> list[Shell]:
    """Return the visible surfaces of the bodies on rank 0, none on the others; collective.

    Args:
        mesh: the bodies.
        interfaces: names of the interfaces of the case; others are called "body/body" in the order
            of the mesh.
    """
    names = {frozenset(name.split("/")): name for name in interfaces}
    order = list(mesh.bodies)
    shells = []
    for body in mesh.bodies.values():
        found = mesh.comm.gather((*_outer_facets(body), _in_space(_owned_cells(body))))
        if found is None:
            continue
        facets, tags, cells = (np.concatenate(own) for own in zip(*found, strict=True))
        skins: dict[str, FloatArray] = {}
        for surface, tag in body.surfaces.items():
            own = facets[tags == tag]
            if surface not in order:
                skins[f"{body.name}/{surface}"] = own
                continue
            pair = sorted((body.name, surface), key=order.index)
            name = names.get(frozenset(pair), "/".join(pair))
            skins |= _parts(name, own, mesh.marked)
        skins[f"{body.name}, unnamed"] = facets[tags == 0]
        skins = {name: corners for name, corners in skins.items() if len(corners)}
        shells.append(Shell(body.name, facets if body.kind.dimension == 3 else cells, skins))
    return shells


def _owned_cells(body: BodyMesh) -> FloatArray:
    """Return the corners of the cells that this rank owns, (cells, corners, gdim)."""
    owned = body.mesh.topology.index_map(body.kind.dimension).size_local
    return body.points[_round(body.kind, body.nodes.dofmap.list[:owned])]


def _outer_facets(body: BodyMesh) -> tuple[FloatArray, IntArray]:
    """Return the corners of the outer facets of owned cells, and the tags of their surfaces or 0.

    Returns:
        (facets, corners, 3) [m] and (facets,).
    """
    topology, kind = body.mesh.topology, body.kind
    dim = topology.dim
    facets_of = topology.connectivity(dim, dim - 1).array.reshape(-1, len(kind.faces))
    facets_of = facets_of[: topology.index_map(dim).size_local]
    beside = np.diff(topology.connectivity(dim - 1, dim).offsets)
    cells, places = np.nonzero(beside[facets_of] == 1)
    tags = np.zeros(len(beside), dtype=np.int32)
    tags[body.facet_tags.indices] = body.facet_tags.values
    nodes = np.take_along_axis(body.nodes.dofmap.list[cells], kind.faces[places], axis=1)
    corners = body.points[_round(KINDS[kind.face], nodes)]
    return _in_space(corners), tags[facets_of[cells, places]]


def _round(kind: CellKind, nodes: IntArray) -> IntArray:
    """Return the nodes of cells, for quadrilaterals in cyclic order."""
    return nodes[:, np.argsort(kind.from_gmsh)] if kind.dimension == 2 else nodes


def _in_space(points: FloatArray) -> FloatArray:
    """Return points (…, 2) or (…, 3) in three dimensions."""
    space = np.zeros((*points.shape[:-1], 3))
    space[..., : points.shape[-1]] = points
    return space


def _parts(
    name: str, facets: FloatArray, marked: Mapping[str, FloatArray]
) -> dict[str, FloatArray]:
    """Return the facets of an interface by the named parts that they lie in, and the others."""
    found, left = {}, np.ones(len(facets), dtype=bool)
    for part, points in marked.items():
        known = {tuple(point) for point in _in_space(points)}
        corners = [tuple(point) in known for point in facets.reshape(-1, 3)]
        inside = np.reshape(corners, facets.shape[:2]).all(axis=1) & left
        found[f"{name}, {part}"] = facets[inside]
        left &= ~inside
    return {**found, name: facets[left]}
