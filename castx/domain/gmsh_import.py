"""Named bodies and surfaces of a gmsh model as arrays, on one rank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import gmsh
import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.domain.cell_kinds import KINDS, CellKind, kinds_of_dimension
from castx.errors import MeshError
from castx.input.problems import among
from castx.meshes.cad.report import Report


@dataclass(frozen=True)
class NamedMesh:
    """Linear cells of one kind with named bodies and surfaces, as arrays on one rank.

    Args:
        kind: of the cells.
        points: (points, gdim) [m].
        cells: (cells, corners), positively oriented, corners in DOLFINx's order.
        bodies: (cells,) index of the body.
        faces: (faces, corners of a face) nodes of the named faces.
        face_surfaces: (faces,) index of the surface.
        surface_names: names of the surfaces.
        report: what was made of CAD files; None without them.
    """

    kind: CellKind
    points: FloatArray
    cells: LongArray
    bodies: LongArray
    faces: LongArray
    face_surfaces: LongArray
    surface_names: tuple[str, ...]
    report: Report | None = None


def read_model(body_names: Sequence[str], dimension: int, source: str) -> NamedMesh:
    """Return the mesh of the current gmsh model.

    Args:
        body_names: the bodies of the case, in their order.
        dimension: 2 or 3, the dimension of the case's model.
        source: origin of the mesh, for messages.

    Raises:
        MeshError: the model's names, elements or dimension do not fit.
    """
    kind = _checked_kind(dimension, source)
    tags, points = _nodes(dimension, source)
    groups = _groups(dimension, source)
    if not groups:
        parts = "volumes" if dimension == 3 else "surfaces"
        raise MeshError(
            f"{source} has no named physical {parts}; name one per body: {', '.join(body_names)}"
        )
    _check_bodies(list(groups), body_names, source)
    cells, bodies = _elements(kind, {name: groups[name] for name in body_names}, source)
    _check_shares(dimension, bodies, body_names, source)
    used, cells = np.unique(np.searchsorted(tags, cells), return_inverse=True)
    points, cells = points[used], cells.reshape(-1, kind.corners)
    _check_numbers(points, tags[used], source)
    surfaces = _groups(dimension - 1, source)
    _check_surfaces(list(surfaces), body_names, source)
    faces, face_surfaces = _elements(KINDS[kind.face], surfaces, source)
    faces, known = _renumbered(np.searchsorted(tags, faces), used)
    return NamedMesh(
        kind,
        points,
        _oriented(kind, points, cells, source),
        bodies,
        faces[known],
        face_surfaces[known],
        tuple(surfaces),
    )


def _checked_kind(dimension: int, source: str) -> CellKind:
    kinds = {dim: list(gmsh.model.mesh.getElementTypes(dim)) for dim in (2, 3)}
    highest = 3 if kinds[3] else 2
    if not kinds[highest]:
        raise MeshError(f"{source} has no surface or volume elements")
    if highest != dimension:
        raise MeshError(
            f"the case's model is {dimension}-D but {source} is a {highest}-D mesh; "
            "change geometry.model or the mesh"
        )
    allowed = {kind.gmsh: kind for kind in kinds_of_dimension(dimension)}
    if len(kinds[dimension]) > 1 or kinds[dimension][0] not in allowed:
        names = (gmsh.model.mesh.getElementProperties(kind)[0] for kind in kinds[dimension])
        known = " or only of ".join(f"linear {kind.plural}" for kind in allowed.values())
        raise MeshError(
            f"{source} has elements of the kinds {', '.join(names)}; it must be only of {known}"
        )
    return allowed[kinds[dimension][0]]


def _nodes(dimension: int, source: str) -> tuple[LongArray, FloatArray]:
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    points = coordinates.reshape(-1, 3)[order]
    if dimension == 2:
        height = np.abs(points[:, 2]).max()
        if height > 1e-9 * np.ptp(points, axis=0).max():
            raise MeshError(
                f"{source} is for a 2-D model but leaves the plane z = 0 by {height:g} m"
            )
    return tags[order].astype(np.int64), np.ascontiguousarray(points[:, :dimension])


def _check_numbers(points: FloatArray, tags: LongArray, source: str) -> None:
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        raise MeshError(
            f"{source}: {len(wrong)} nodes have coordinates that are no finite numbers, the first "
            f"is node {tags[wrong[0]]}; repair it or export the mesh again"
        )


def _groups(dim: int, source: str) -> dict[str, list[int]]:
    """Return the tags of the entities of physical groups, by name."""
    groups: dict[str, list[int]] = {}
    for _, tag in gmsh.model.getPhysicalGroups(dim):
        name = gmsh.model.getPhysicalName(dim, tag)
        if not name:
            raise MeshError(
                f"{source} has a physical group without a name: dimension {dim}, number {tag}"
            )
        groups.setdefault(name, []).extend(gmsh.model.getEntitiesForPhysicalGroup(dim, tag))
    return groups


def _check_bodies(found: Sequence[str], wanted: Sequence[str], source: str) -> None:
    for name in wanted:
        if name not in found:
            known = among(name, found, what="it has")
            raise MeshError(f"{source} has no body {name!r}; {known}")
    extra = [name for name in found if name not in wanted]
    if extra:
        raise MeshError(
            f"{source} has bodies that the case does not list under [[bodies]]: {', '.join(extra)}"
        )


def _check_surfaces(found: Sequence[str], bodies: Sequence[str], source: str) -> None:
    clash = [name for name in found if name in bodies]
    if clash:
        raise MeshError(
            f"{source} has a surface with the name of a body: {clash[0]!r}; rename the surface "
            "(faces that two bodies share are named after the other body by themselves)"
        )


def _elements(
    kind: CellKind, groups: dict[str, list[int]], source: str
) -> tuple[LongArray, LongArray]:
    """Return the tags of nodes (elements, corners), and the index of the group of each element."""
    nodes, owners = [np.empty((0, kind.corners), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    name_of: dict[int, str] = {}
    for index, (name, entities) in enumerate(groups.items()):
        for entity in entities:
            if entity in name_of:
                raise MeshError(
                    f"{source}: {name_of[entity]!r} and {name!r} overlap; a part has one name"
                )
            name_of[entity] = name
            _, corners = gmsh.model.mesh.getElementsByType(kind.gmsh, entity)
            corners = corners.reshape(-1, kind.corners)[:, kind.from_gmsh]
            nodes.append(corners.astype(np.int64))
            owners.append(np.full(len(nodes[-1]), index))
    return np.concatenate(nodes), np.concatenate(owners)


def _check_shares(dim: int, bodies: LongArray, names: Sequence[str], source: str) -> None:
    empty = [name for index, name in enumerate(names) if not (bodies == index).any()]
    if empty:
        raise MeshError(f"{source}: the body {empty[0]!r} has no elements")
    total = sum(len(tags) for tags in gmsh.model.mesh.getElements(dim)[1])
    if total != len(bodies):
        raise MeshError(
            f"{source}: {total - len(bodies)} of {total} elements belong to no named body; "
            "give every part a physical group"
        )


def _renumbered(nodes: LongArray, used: LongArray) -> tuple[LongArray, BoolArray]:
    """Return nodes as places in `used`, and which rows have all their nodes there."""
    place = np.minimum(np.searchsorted(used, nodes), len(used) - 1)
    return place, (used[place] == nodes).all(axis=1)


def _oriented(kind: CellKind, points: FloatArray, cells: LongArray, source: str) -> LongArray:
    corners = points[cells]
    volume = kind.corner_volumes(corners)
    size = np.ptp(corners, axis=1).max(axis=1) ** kind.dimension
    negative = volume[:, 0] < 0
    least = np.where(negative[:, None], -volume, volume).min(axis=1)
    bad = np.flatnonzero(least < 1e-12 * size)
    if len(bad):
        place = ", ".join(f"{x:g}" for x in corners[bad[0]].mean(axis=0))
        what = "have no volume" if kind.simplex else "are flat or not convex"
        raise MeshError(
            f"{source}: {len(bad)} elements {what}, the first at ({place}) m; repair the mesh there"
        )
    return np.where(negative[:, None], cells[:, kind.mirrored], cells)
