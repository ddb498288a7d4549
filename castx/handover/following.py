"""Motion of the nodes of a mesh that follow those of one body."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.errors import MeshError

FACES = {
    3: [[0, 1], [1, 2], [2, 0]],
    4: [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]],
    -4: [[0, 1], [1, 2], [2, 3], [3, 0]],
    8: [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]],
}
"""Corners of the faces of cells by their number; -4: of quadrilaterals."""


def followed(
    nodes: FloatArray, cells: list[LongArray], leading: LongArray, motion: FloatArray
) -> FloatArray:
    """Return the places of all nodes when some of them are moved, (nodes, 3) [m].

    Others move by the mean of their neighbours; those of other bodies on the outer surface of the
    mesh stay.

    Args:
        nodes: their places, (nodes, 3) [m].
        cells: nodes of the cells of highest dimension, by kind, (cells, corners).
        leading: nodes that are moved, (moved,).
        motion: of these, (moved, 3) [m].

    Raises:
        MeshError: cells are turned over by the motion.
    """
    moves: FloatArray = np.zeros_like(nodes)
    moves[leading] = motion
    plane = not np.ptp(nodes[:, 2])
    fixed = _outer(cells, len(nodes), plane)
    fixed[leading] = True
    rows, columns = np.concatenate([
        corners[:, list(pair)].T for corners in cells
        for pair in combinations(range(corners.shape[1]), 2)
    ], axis=1)  # fmt: skip
    links = scipy.sparse.coo_array(
        (np.ones(len(rows)), (rows, columns)), shape=(len(nodes), len(nodes))
    ).tocsr()
    links = links + links.T
    free = np.flatnonzero(~fixed & (links.sum(axis=1) > 0))
    if free.size:
        balance = scipy.sparse.diags_array(links.sum(axis=1)).tocsr() - links
        loads = -(balance[free][:, np.flatnonzero(fixed)] @ moves[fixed])
        solve = scipy.sparse.linalg.factorized(balance[free][:, free].tocsc())
        moves[free] = np.column_stack([solve(column) for column in loads.T])
    _refuse_turned(nodes, moves, cells, plane)
    return np.asarray(nodes + moves)


def _outer(cells: list[LongArray], count: int, plane: bool) -> BoolArray:
    """Return a mask of the nodes on the surface of the whole mesh, (nodes,)."""
    outer: BoolArray = np.zeros(count, dtype=bool)
    for corners in cells:
        kind = corners.shape[1]
        faces = corners[:, FACES[-kind if plane and kind == 4 else kind]]
        faces = faces.reshape(-1, faces.shape[2])
        _, first, found = np.unique(
            np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
        )
        outer[faces[first[found == 1]]] = True
    return outer


def _refuse_turned(
    nodes: FloatArray, moves: FloatArray, cells: list[LongArray], plane: bool
) -> None:
    for corners in cells:
        before, after = (_measure(places[corners], plane) for places in (nodes, nodes + moves))
        turned = np.flatnonzero(before * after <= 0.0)
        if turned.size:
            place = nodes[corners[turned[0]]].mean(axis=0)
            raise MeshError(
                f"the motion turns {turned.size} cells over, the first at {place.tolist()} m; mesh "
                "the space beside the part with larger cells"
            )


def _measure(corners: FloatArray, plane: bool) -> FloatArray:
    """Return the signed size at the first corner of cells, up to a factor, (cells,)."""
    edges = corners[:, 1:] - corners[:, :1]
    if plane:
        return np.asarray(np.cross(edges[:, 0], edges[:, -1])[:, 2])
    side, last = (2, 3) if corners.shape[1] == 8 else (1, 2)
    area = np.cross(edges[:, 0], edges[:, side])
    return np.asarray(np.einsum("ci,ci->c", area, edges[:, last]))
