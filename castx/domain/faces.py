"""Neighbours across faces, and the name of every outer face of a body."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.domain.gmsh_import import NamedMesh
from castx.errors import MeshError

NO_NEIGHBOUR = -1
INSIDE = -1


def face_keys(*groups: LongArray) -> list[LongArray]:
    """Return numbers that are equal for faces with the same nodes, by group.

    Args:
        groups: nodes of faces in any order, shapes (faces, nodes).
    """
    faces = np.sort(np.concatenate(groups), axis=1)
    keys = faces[:, 0]
    span = int(faces.max()) + 1
    for column in faces.T[1:]:
        keys = np.unique(keys * span + column, return_inverse=True)[1]
    return np.split(keys, np.cumsum([len(group) for group in groups])[:-1])


def cell_faces(cells: LongArray, faces: LongArray) -> LongArray:
    """Return the nodes of the faces of cells, cell by cell in the order of DOLFINx.

    Args:
        cells: (cells, corners).
        faces: corners of each face of a cell, (faces, nodes).

    Returns:
        Shape (cells * faces, nodes).
    """
    return cells[:, faces].reshape(-1, faces.shape[1])


def neighbours(cells: LongArray, faces: LongArray, source: str) -> LongArray:
    """Return the cell across each face, (cells, faces), `NO_NEIGHBOUR` outside.

    Args:
        cells: (cells, corners).
        faces: corners of each face of a cell, (faces, nodes).
        source: origin of the mesh, for messages.

    Raises:
        MeshError: more than two cells share a face.
    """
    (keys,) = face_keys(cell_faces(cells, faces))
    order = np.argsort(keys, kind="stable")
    same = keys[order][1:] == keys[order][:-1]
    if (same[1:] & same[:-1]).any():
        raise MeshError(f"{source}: more than two elements share a face; the parts overlap")
    across = np.full(len(keys), NO_NEIGHBOUR, dtype=np.int64)
    first, second = order[:-1][same], order[1:][same]
    across[first] = second // len(faces)
    across[second] = first // len(faces)
    return across.reshape(len(cells), len(faces))


def marked_between(mesh: NamedMesh, across: LongArray) -> dict[str, FloatArray]:
    """Return the points of named faces between two bodies, by name.

    Args:
        mesh: the mesh.
        across: the cell across each face, (cells, faces).

    Returns:
        Shapes (points, gdim) [m].
    """
    cell_keys, named_keys = face_keys(cell_faces(mesh.cells, mesh.kind.faces), mesh.faces)
    between = (across != NO_NEIGHBOUR) & (mesh.bodies[across] != mesh.bodies[:, None])
    inner = np.isin(named_keys, cell_keys[between.ravel()])
    found = {}
    for index, name in enumerate(mesh.surface_names):
        faces = mesh.faces[inner & (mesh.face_surfaces == index)]
        if len(faces):
            found[name] = mesh.points[np.unique(faces)]
    return found


def face_names(mesh: NamedMesh, across: LongArray, source: str) -> LongArray:
    """Return the name of each face of each cell as a number, (cells, faces).

    `INSIDE` for faces within a body and outer ones without a name; else the index of the surface,
    or, towards another body, the number of surfaces plus the index of that body.

    Args:
        mesh: the mesh.
        across: the cell across each face, (cells, faces).
        source: origin of the mesh, for messages.

    Raises:
        MeshError: a face has two names.
    """
    outer = across == NO_NEIGHBOUR
    cell_keys, named_keys = face_keys(cell_faces(mesh.cells, mesh.kind.faces), mesh.faces)
    surfaces = np.full(cell_keys.max() + 1, INSIDE, dtype=np.int64)
    if len(named_keys):
        surfaces = np.full(max(cell_keys.max(), named_keys.max()) + 1, INSIDE, dtype=np.int64)
        surfaces[named_keys] = mesh.face_surfaces
        double = np.flatnonzero(surfaces[named_keys] != mesh.face_surfaces)
        if len(double):
            a, b = surfaces[named_keys[double[0]]], mesh.face_surfaces[double[0]]
            raise MeshError(
                f"{source}: surfaces {mesh.surface_names[b]!r} and {mesh.surface_names[a]!r} "
                "overlap; a face has one name"
            )
    names = np.where(outer, surfaces[cell_keys].reshape(across.shape), INSIDE)
    other = mesh.bodies[across]
    between = ~outer & (other != mesh.bodies[:, None])
    return np.where(between, len(mesh.surface_names) + other, names)
