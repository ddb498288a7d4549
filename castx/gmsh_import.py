"""Reading named bodies and surfaces out of gmsh, on one rank."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import gmsh
import numpy as np
from numpy.typing import NDArray

from castx.errors import MeshError
from castx.refusal import among

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

LINEAR_SIMPLEX = {1: 1, 2: 2, 3: 4}
"""gmsh's number of the linear line, triangle and tetrahedron, by dimension."""


@dataclass(frozen=True)
class NamedMesh:
    """Linear simplices with named bodies and surfaces, as arrays on one rank.

    Args:
        points: (points, gdim) [m].
        cells: (cells, gdim + 1), positively oriented.
        bodies: (cells,) index of the body.
        faces: (faces, gdim) nodes of the named faces.
        face_surfaces: (faces,) index of the surface.
        surface_names: names of the surfaces.
    """

    points: FloatArray
    cells: IntArray
    bodies: IntArray
    faces: IntArray
    face_surfaces: IntArray
    surface_names: tuple[str, ...]


def read_model(body_names: Sequence[str], dimension: int, source: str) -> NamedMesh:
    """Read the current gmsh model.

    Args:
        body_names: the bodies of the case, in their order.
        dimension: 2 or 3, the dimension of the case's model.
        source: what the mesh comes from, for messages.

    Raises:
        MeshError: the model's names, elements or dimension do not fit.
    """
    _check_elements(dimension, source)
    tags, points = _nodes(dimension, source)
    groups = _groups(dimension, source)
    if not groups:
        kind = "volumes" if dimension == 3 else "surfaces"
        raise MeshError(
            f"{source} has no named physical {kind}; name one per body: {', '.join(body_names)}"
        )
    _check_bodies(list(groups), body_names, source)
    cells, bodies = _elements(dimension, {name: groups[name] for name in body_names}, source)
    _check_shares(dimension, bodies, body_names, source)
    used, cells = np.unique(np.searchsorted(tags, cells), return_inverse=True)
    points, cells = points[used], cells.reshape(-1, dimension + 1)
    surfaces = _groups(dimension - 1, source)
    _check_surfaces(list(surfaces), body_names, source)
    faces, face_surfaces = _elements(dimension - 1, surfaces, source)
    faces, known = _renumbered(np.searchsorted(tags, faces), used)
    return NamedMesh(
        points,
        _oriented(points, cells, source),
        bodies,
        faces[known],
        face_surfaces[known],
        tuple(surfaces),
    )


def _check_elements(dimension: int, source: str) -> None:
    kinds = {dim: list(gmsh.model.mesh.getElementTypes(dim)) for dim in (2, 3)}
    highest = 3 if kinds[3] else 2
    if not kinds[highest]:
        raise MeshError(f"{source} has no surface or volume elements")
    if highest != dimension:
        raise MeshError(
            f"the case's model is {dimension}-D but {source} is a {highest}-D mesh; "
            "change geometry.model or the mesh"
        )
    if kinds[dimension] != [LINEAR_SIMPLEX[dimension]]:
        names = (gmsh.model.mesh.getElementProperties(kind)[0] for kind in kinds[dimension])
        allowed = "tetrahedra" if dimension == 3 else "triangles"
        raise MeshError(
            f"{source} has elements of the kinds {', '.join(names)}; "
            f"only linear {allowed} are allowed"
        )


def _nodes(dimension: int, source: str) -> tuple[IntArray, FloatArray]:
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


def _groups(dim: int, source: str) -> dict[str, list[int]]:
    """Physical groups by name: the tags of their entities."""
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


def _elements(dim: int, groups: dict[str, list[int]], source: str) -> tuple[IntArray, IntArray]:
    """Node tags (elements, dim + 1) and index of the group of each element."""
    nodes, owners = [np.empty((0, dim + 1), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    name_of: dict[int, str] = {}
    for index, (name, entities) in enumerate(groups.items()):
        for entity in entities:
            if entity in name_of:
                raise MeshError(
                    f"{source}: {name_of[entity]!r} and {name!r} overlap; a part has one name"
                )
            name_of[entity] = name
            _, corners = gmsh.model.mesh.getElementsByType(LINEAR_SIMPLEX[dim], entity)
            nodes.append(corners.reshape(-1, dim + 1).astype(np.int64))
            owners.append(np.full(len(nodes[-1]), index))
    return np.concatenate(nodes), np.concatenate(owners)


def _check_shares(dim: int, bodies: IntArray, names: Sequence[str], source: str) -> None:
    empty = [name for index, name in enumerate(names) if not (bodies == index).any()]
    if empty:
        raise MeshError(f"{source}: the body {empty[0]!r} has no elements")
    total = sum(len(tags) for tags in gmsh.model.mesh.getElements(dim)[1])
    if total != len(bodies):
        raise MeshError(
            f"{source}: {total - len(bodies)} of {total} elements belong to no named body; "
            "give every part a physical group"
        )


def _renumbered(nodes: IntArray, used: IntArray) -> tuple[IntArray, NDArray[np.bool_]]:
    """Nodes numbered by their place in `used`, and which rows are known completely."""
    place = np.minimum(np.searchsorted(used, nodes), len(used) - 1)
    return place, (used[place] == nodes).all(axis=1)


def _oriented(points: FloatArray, cells: IntArray, source: str) -> IntArray:
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    volume = np.linalg.det(edges)
    size = np.abs(edges).max(axis=(1, 2)) ** edges.shape[1]
    flat = np.flatnonzero(np.abs(volume) < 1e-12 * size)
    if len(flat):
        place = ", ".join(f"{x:g}" for x in points[cells[flat[0]]].mean(axis=0))
        raise MeshError(f"{source}: {len(flat)} elements have no volume, the first at ({place}) m")
    turned = cells.copy()
    turned[volume < 0, -2:] = cells[volume < 0][:, [-1, -2]]
    return turned
