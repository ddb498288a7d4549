"""Meshes that can be read but not be meant: folded, cracked, with holes, or far from the origin."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.domain.faces import NO_NEIGHBOUR, cell_faces, face_keys
from castx.domain.gmsh_import import NamedMesh
from castx.errors import MeshError

FARTHEST = 1e6
"""Distance from the origin in extents of the mesh; beyond, gaps drown in rounding."""
SAME_PLACE = 1e-9
"""Distance of doubled nodes in extents of the mesh."""
SMALL_HOLE = 4.0
"""Volume of a hole in cells beside it up to which it may be a missing cell."""
SMALLEST_EXTENT, LARGEST_EXTENT = 1e-9, 1e6
"""Extents of meshes that may be meant [m]: from atoms to a country."""
USUAL_EXTENT = 100.0
"""Extent beyond which a casting with its mould is probably in a mistaken unit [m]."""
STRAY = 0.02
"""Share of the cells of a body up to which a part of it that hangs together with no other may be
stray; a single cell may be so in a body of eight and more."""


def refuse_far_away(mesh: NamedMesh, source: str) -> None:
    """Refuse a mesh so far from the origin that its coordinates lose their digits.

    Raises:
        MeshError: with distance and extent.
    """
    extent = float(np.ptp(mesh.points, axis=0).max())
    distance = float(np.abs(mesh.points).max())
    if distance > FARTHEST * extent:
        raise MeshError(
            f"{source} lies {distance:.3g} m from the origin, {distance / extent:.1g} times its "
            f"extent of {extent:.3g} m; at most {FARTHEST:g} times are allowed, since coordinates "
            "lose their digits; move it to the origin"
        )


def refuse_absurd_extent(mesh: NamedMesh, source: str) -> None:
    """Refuse a mesh that is smaller or larger than anything that is cast.

    Raises:
        MeshError: with the extent.
    """
    extent = float(np.ptp(mesh.points, axis=0).max())
    if not SMALLEST_EXTENT <= extent <= LARGEST_EXTENT:
        raise MeshError(
            f"{source} has an extent of {extent:.3g} m; {SMALLEST_EXTENT:g} to "
            f"{LARGEST_EXTENT:g} m are allowed; meshes are in metres: scale its coordinates"
        )


def refuse_folded(mesh: NamedMesh, across: LongArray, source: str) -> None:
    """Refuse overlapping cells: both lie on the same side of their common face.

    Args:
        mesh: the mesh.
        across: the cell across each face, (cells, faces).
        source: origin of the mesh, for messages.

    Raises:
        MeshError: with number and place.
    """
    cell, face = np.nonzero(across > np.arange(len(mesh.cells))[:, None])
    nodes = mesh.cells[cell[:, None], mesh.kind.faces[face]]
    centres = mesh.points[nodes].mean(axis=1)
    normals = area_vectors(mesh.points[nodes])
    middles = mesh.points[mesh.cells].mean(axis=1)
    heights = [
        np.einsum("fi,fi->f", normals, middles[cells] - centres)
        for cells in (cell, across[cell, face])
    ]
    folded = np.flatnonzero(heights[0] * heights[1] > 0.0)
    if folded.size:
        raise MeshError(
            f"{source}: {folded.size} pairs of neighbouring elements lie over each other, the "
            f"first at ({_place(centres[folded[0]])}) m; has a node been moved out of place? "
            "repair the mesh there"
        )


def doubts(mesh: NamedMesh, body_names: tuple[str, ...], across: LongArray) -> Iterator[str]:
    """Yield warnings of probable mistakes.

    These are duplicate nodes of a body, holes of the size of a cell, cells of a body that lie
    apart in another one, and a mistaken unit.

    Args:
        mesh: the mesh.
        body_names: names of the bodies.
        across: the cell across each face, (cells, faces).
    """
    free = across == NO_NEIGHBOUR
    faces = cell_faces(mesh.cells, mesh.kind.faces)[free.ravel()]
    cells = np.nonzero(free)[0]
    for index, name in enumerate(body_names):
        yield from _doubled(mesh, name, np.unique(faces[mesh.bodies[cells] == index]))
    yield from _holes(mesh, faces, cells)
    yield from _stray(mesh, body_names, across)
    extent = float(np.ptp(mesh.points, axis=0).max())
    if extent > USUAL_EXTENT:
        yield (
            f"the mesh has an extent of {extent:.3g} m; meshes are in metres: if its file is in "
            "millimetres, divide its coordinates by 1000"
        )


def area_vectors(corners: FloatArray) -> FloatArray:
    """Return normals of faces, as long as the faces are large.

    Args:
        corners: (faces, corners, gdim) in the order of DOLFINx [m].
    """
    if corners.shape[1] == 2:
        edge = corners[:, 1] - corners[:, 0]
        return np.column_stack([edge[:, 1], -edge[:, 0]])
    if corners.shape[1] == 3:
        sides = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    else:  # diagonals
        sides = corners[:, 3] - corners[:, 0], corners[:, 2] - corners[:, 1]
    return np.asarray(0.5 * np.cross(*sides))


def _doubled(mesh: NamedMesh, body: str, nodes: LongArray) -> Iterator[str]:
    points = mesh.points[nodes]
    pairs = cKDTree(points).query_pairs(SAME_PLACE * float(np.ptp(mesh.points, axis=0).max()))
    if pairs:
        first = points[min(pairs)[0]]
        yield (
            f"{body} has {len(pairs)} pairs of nodes at the same place, the first at "
            f"({_place(first)}) m: neither heat nor force passes between the elements there; merge "
            "the nodes (gmsh: Coherence Mesh), unless a crack is meant"
        )


def _stray(mesh: NamedMesh, body_names: tuple[str, ...], across: LongArray) -> Iterator[str]:
    """Yield small parts of bodies that share no face with the others of their body."""
    cell, face = np.nonzero(across != NO_NEIGHBOUR)
    beside = across[cell, face]
    inside = mesh.bodies[cell] == mesh.bodies[beside]
    shape = (len(mesh.cells),) * 2
    links = coo_matrix((np.ones(int(inside.sum())), (cell[inside], beside[inside])), shape=shape)
    part = connected_components(links.tocsr(), directed=False)[1]
    sizes = np.bincount(part)[part]
    enclosed = np.isin(part, part[cell[~inside]])
    of_body = np.bincount(mesh.bodies, minlength=len(body_names))[mesh.bodies]
    stray = sizes <= np.maximum(STRAY * of_body, of_body >= 8)
    kinds = {
        "in another body": (
            enclosed,
            "do they belong to that body? correct their physical group, unless inclusions are "
            "meant",
        ),
        "and touch no body": (
            ~enclosed,
            "are they a remnant? neither heat nor force passes between; remove them, or make them "
            "a body of their own",
        ),
    }
    for index, name in enumerate(body_names):
        for where, (chosen, cure) in kinds.items():
            found = np.flatnonzero(stray & chosen & (mesh.bodies == index))
            if found.size:
                centre = mesh.points[mesh.cells[found[0]]].mean(axis=0)
                yield (
                    f"{name} has {found.size} elements that lie apart from its others {where}, "
                    f"the first at ({_place(centre)}) m: {cure}"
                )


def _holes(mesh: NamedMesh, faces: LongArray, cells: LongArray) -> Iterator[str]:
    corners = mesh.points[faces]
    centres = corners.mean(axis=1)
    normals = area_vectors(corners)
    inward = np.einsum("fi,fi->f", normals, mesh.points[mesh.cells[cells]].mean(axis=1) - centres)
    normals[inward > 0.0] *= -1.0
    group = _connected(faces)
    count = int(group.max()) + 1
    # The volume that faces enclose whose normals point out of the cells: negative round a hole.
    first = centres[np.unique(group, return_index=True)[1]]
    dimension = mesh.kind.dimension
    parts = np.einsum("fi,fi->f", normals, centres - first[group]) / dimension
    enclosed = np.bincount(group, parts, minlength=count)
    beside = np.bincount(group, _volumes(mesh, cells), minlength=count) / np.bincount(group)
    named = np.zeros(count, dtype=bool)
    named[group[_have_names(mesh, faces)]] = True
    small = (enclosed < -1e-6 * beside) & (enclosed > -SMALL_HOLE * beside) & ~named
    found = np.flatnonzero(small)
    if found.size:
        place = _place(centres[group == found[0]].mean(axis=0))
        yield (
            f"{found.size} holes inside are no larger than {SMALL_HOLE:g} elements, the first at "
            f"({place}) m: are elements missing? fill them, or name their faces if they are meant"
        )


def _connected(faces: LongArray) -> LongArray:
    """Return a number for each face that is the same for those connected over their edges."""
    corners = {2: ((0,), (1,)), 3: ((0, 1), (0, 2), (1, 2)), 4: ((0, 1), (0, 2), (1, 3), (2, 3))}
    edges = np.array(corners[faces.shape[1]])
    ridges = cell_faces(faces, edges)
    (keys,) = face_keys(ridges)
    keys = np.unique(keys, return_inverse=True)[1]
    owners = np.repeat(np.arange(len(faces)), len(edges))
    shape = (len(faces), int(keys.max()) + 1)
    touching = coo_matrix((np.ones(len(keys)), (owners, keys)), shape=shape).tocsr()
    return np.asarray(connected_components(touching @ touching.T, directed=False)[1])


def _volumes(mesh: NamedMesh, cells: LongArray) -> FloatArray:
    """Return the volumes of cells, from the means of their corners."""
    jacobians = mesh.kind.corner_volumes(mesh.points[mesh.cells[cells]]).mean(axis=1)
    size = {"triangle": 2.0, "tetrahedron": 6.0}.get(mesh.kind.name, 1.0)
    return np.asarray(np.abs(jacobians) / size)


def _have_names(mesh: NamedMesh, faces: LongArray) -> BoolArray:
    if not len(mesh.faces):
        return np.zeros(len(faces), dtype=bool)
    keys, named = face_keys(faces, mesh.faces)
    return np.asarray(np.isin(keys, named))


def _place(point: FloatArray) -> str:
    return ", ".join(f"{x:g}" for x in point)
