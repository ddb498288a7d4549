"""Plane triangulations, mirrored or swept into tetrahedra."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
Regions = Callable[[FloatArray], IntArray]


@dataclass(frozen=True)
class Simplices:
    """Triangles or tetrahedra with the region that each belongs to.

    Args:
        points: (points, 2) or (points, 3) [m].
        cells: (cells, 3) or (cells, 4), positively oriented.
        regions: (cells,) index of the body.
        order: (points,) the order in which the nodes of a triangle are taken when it is swept;
            different for the three nodes of each triangle, equal for a node and its mirror image.
    """

    points: FloatArray
    cells: IntArray
    regions: IntArray
    order: IntArray


def grid(x: FloatArray, y: FloatArray, regions: Regions) -> Simplices:
    """Right-angled triangles on a rectangular grid, mirror-symmetric about every grid line.

    Each rectangle is cut by the diagonal between its even-even and its odd-odd node ("union jack"):
    no obtuse angles at any aspect ratio. Rectangles of a negative region are left out.

    Args:
        x: (nx,) grid lines [m].
        y: (ny,) grid lines [m].
        regions: maps midpoints (n, 2) to regions (n,).
    """
    i, j = np.indices((len(x) - 1, len(y) - 1)).reshape(2, -1)
    middle = np.column_stack([0.5 * (x[i] + x[i + 1]), 0.5 * (y[j] + y[j + 1])])
    region = regions(middle)
    kept = region >= 0
    i, j, region = i[kept], j[kept], region[kept]
    even_i, even_j, odd_i, odd_j = i + i % 2, j + j % 2, i + 1 - i % 2, j + 1 - j % 2
    even, odd = even_i * len(y) + even_j, odd_i * len(y) + odd_j
    cells = np.concatenate(
        [np.column_stack([even, odd_i * len(y) + even_j, odd]),
         np.column_stack([even, even_i * len(y) + odd_j, odd])]
    )  # fmt: skip
    all_i, all_j = np.indices((len(x), len(y))).reshape(2, -1)
    points = np.column_stack([x[all_i], y[all_j]])
    return compacted(
        Simplices(points, oriented(points, cells), np.tile(region, 2), all_i % 2 + all_j % 2)
    )


def compacted(mesh: Simplices) -> Simplices:
    """Leave out the points that no cell uses."""
    used, cells = np.unique(mesh.cells, return_inverse=True)
    return Simplices(
        mesh.points[used], cells.reshape(mesh.cells.shape), mesh.regions, mesh.order[used]
    )


def volumes(points: FloatArray, cells: IntArray) -> FloatArray:
    """Signed volume (area) of tetrahedra (triangles) [m³, m²]."""
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    return np.linalg.det(edges) / (2.0 if cells.shape[1] == 3 else 6.0)


def oriented(points: FloatArray, cells: IntArray) -> IntArray:
    """The same cells with positive volumes."""
    turned = cells.copy()
    negative = volumes(points, cells) < 0
    turned[negative, -2:] = cells[negative][:, [-1, -2]]
    return turned


def mirrored(mesh: Simplices, axis: int) -> Simplices:
    """A mesh in coordinate >= 0 with its mirror image in the plane where it is zero."""
    on_plane = np.abs(mesh.points[:, axis]) < 1e-9 * np.ptp(mesh.points[:, axis])
    points = mesh.points.copy()
    points[on_plane, axis] = 0.0
    images = points[~on_plane].copy()
    images[:, axis] *= -1.0
    image_of = np.arange(len(points))
    image_of[~on_plane] = len(points) + np.arange(len(images))
    points = np.concatenate([points, images])
    return Simplices(
        points,
        np.concatenate([mesh.cells, oriented(points, image_of[mesh.cells])]),
        np.tile(mesh.regions, 2),
        np.concatenate([mesh.order, mesh.order[~on_plane]]),
    )


def swept(
    mesh: Simplices, z: FloatArray, regions: Callable[[IntArray, float], IntArray]
) -> Simplices:
    """Tetrahedra from triangles moved along z; every other layer is cut in the mirrored way.

    Args:
        mesh: triangles (x, y).
        z: (nz,) levels [m].
        regions: region of the tetrahedra of one layer from (regions of the triangles, its middle
            z); a negative region leaves them out.
    """
    order = mesh.order[mesh.cells]
    a, b, c = np.take_along_axis(mesh.cells, np.argsort(order, axis=1), axis=1).T
    cells, found = [], []
    for layer in range(len(z) - 1):
        low, high = len(mesh.points) * (layer + np.array([layer % 2, 1 - layer % 2]))
        region = regions(mesh.regions, 0.5 * (z[layer] + z[layer + 1]))
        prism = [[a + low, b + low, c + low, c + high],
                 [a + low, b + low, b + high, c + high],
                 [a + low, a + high, b + high, c + high]]  # fmt: skip
        for corners in prism:
            cells.append(np.column_stack(corners)[region >= 0])
            found.append(region[region >= 0])
    points = np.column_stack([np.tile(mesh.points, (len(z), 1)), np.repeat(z, len(mesh.points))])
    order = np.tile(mesh.order, len(z))
    all_cells = oriented(points, np.concatenate(cells))
    return compacted(Simplices(points, all_cells, np.concatenate(found), order))
