"""Linear meshes of one kind of cells: orientation, mirror images, free faces."""

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, LongArray

SIMPLICES, QUADRILATERALS = "simplices", "quadrilaterals"
"""Cells of a generator: triangles and tetrahedra, or quadrilaterals and hexahedra."""


@dataclass(frozen=True)
class GmshCellKind:
    """Arrangement of the corners of a kind of cells in the numbering of gmsh.

    Args:
        gmsh: gmsh's number of the kind.
        along: corners joined to corner 0 by the edges that are right-handed in this order.
        mirrored: corners in an order that makes a proper cell of a mirror image.
        faces: corners of each face, in the order of a cell of the lower dimension.
    """

    gmsh: int
    along: tuple[int, ...]
    mirrored: tuple[int, ...]
    faces: tuple[tuple[int, ...], ...]


KINDS = {
    (2, 3): GmshCellKind(2, (1, 2), (0, 2, 1), ((0, 1), (1, 2), (2, 0))),
    (2, 4): GmshCellKind(3, (1, 3), (0, 3, 2, 1), ((0, 1), (1, 2), (2, 3), (3, 0))),
    (3, 4): GmshCellKind(4, (1, 2, 3), (0, 1, 3, 2), ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2))),
    (3, 8): GmshCellKind(
        5,
        (1, 3, 4),
        (0, 3, 2, 1, 4, 7, 6, 5),
        ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
    ),
}
"""By dimension and number of corners."""


@dataclass(frozen=True)
class LinearMesh:
    """Cells of one kind with the region that each belongs to.

    Args:
        points: (points, 2) or (points, 3) [m].
        cells: (cells, corners), positively oriented.
        regions: (cells,) index of the body.
        order: (points,) the order in which the nodes of a triangle are taken when it is swept;
            different for the three nodes of each triangle, equal for a node and its mirror image.
    """

    points: FloatArray
    cells: LongArray
    regions: LongArray
    order: LongArray

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return self.points.shape[1]

    @property
    def kind(self) -> GmshCellKind:
        """Arrangement of the corners of its cells."""
        return KINDS[self.dimension, self.cells.shape[1]]


def checked_cells(cells: str) -> str:
    """Return the kind of cells asked for, or refuse it."""
    if cells not in (SIMPLICES, QUADRILATERALS):
        raise ValueError(f"cells must be {SIMPLICES} or {QUADRILATERALS}, got {cells!r}")
    return cells


def compacted(mesh: LinearMesh) -> LinearMesh:
    """Return the mesh without the points that no cell uses."""
    used, cells = np.unique(mesh.cells, return_inverse=True)
    return LinearMesh(
        mesh.points[used], cells.reshape(mesh.cells.shape), mesh.regions, mesh.order[used]
    )


def handedness(points: FloatArray, cells: LongArray) -> FloatArray:
    """Return the determinants of the edges at corner 0, positive in proper cells [m², m³]."""
    along = KINDS[points.shape[1], cells.shape[1]].along
    determinants: FloatArray = np.linalg.det(points[cells[:, along]] - points[cells[:, :1]])
    return determinants


def oriented(points: FloatArray, cells: LongArray) -> LongArray:
    """Return the cells with positive orientation."""
    kind = KINDS[points.shape[1], cells.shape[1]]
    negative = handedness(points, cells) < 0
    return np.where(negative[:, None], cells[:, kind.mirrored], cells)


def mirrored(mesh: LinearMesh, axis: int) -> LinearMesh:
    """Return a mesh on one side of a plane with its mirror image.

    Args:
        mesh: where the coordinate is not negative.
        axis: number of the coordinate, zero in the plane.
    """
    on_plane = np.abs(mesh.points[:, axis]) < 1e-9 * np.ptp(mesh.points[:, axis])
    points = mesh.points.copy()
    points[on_plane, axis] = 0.0
    images = points[~on_plane].copy()
    images[:, axis] *= -1.0
    image_of = np.arange(len(points))
    image_of[~on_plane] = len(points) + np.arange(len(images))
    return LinearMesh(
        np.concatenate([points, images]),
        np.concatenate([mesh.cells, image_of[mesh.cells[:, mesh.kind.mirrored]]]),
        np.tile(mesh.regions, 2),
        np.concatenate([mesh.order, mesh.order[~on_plane]]),
    )


def free_faces(mesh: LinearMesh) -> LongArray:
    """Return the faces of one cell only, (faces, nodes)."""
    faces = np.concatenate([mesh.cells[:, corners] for corners in mesh.kind.faces])
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer: LongArray = faces[first[count == 1]]
    return outer
