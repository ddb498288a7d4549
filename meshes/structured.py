"""Meshes on a rectangular grid, and plane meshes swept into bodies."""

from collections.abc import Callable

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.linear_mesh import QUADRILATERALS, SIMPLICES, LinearMesh, compacted, oriented

Regions = Callable[[FloatArray], LongArray]
LayerRegions = Callable[[LongArray, float], LongArray]


def grid(
    x: FloatArray,
    y: FloatArray,
    regions: Regions,
    cells: str = SIMPLICES,
    corner: tuple[int, int] = (0, 0),
) -> LinearMesh:
    """Return quadrilaterals or right-angled triangles on a grid, symmetric about grid lines.

    For triangles each rectangle is cut by the diagonal between its even-even and its odd-odd node
    ("union jack"): no obtuse angles at any aspect ratio. Rectangles of a negative region are left
    out.

    Args:
        x: (nx,) grid lines [m].
        y: (ny,) grid lines [m].
        regions: maps midpoints (n, 2) to regions (n,).
        cells: "simplices" or "quadrilaterals".
        corner: grid lines at a corner of a region, where their counting starts: no triangle has
            all its nodes on the sides of that corner.
    """
    i, j = np.indices((len(x) - 1, len(y) - 1)).reshape(2, -1)
    middle = np.column_stack([0.5 * (x[i] + x[i + 1]), 0.5 * (y[j] + y[j + 1])])
    region = regions(middle)
    kept = region >= 0
    i, j, region = i[kept], j[kept], region[kept]
    if cells == QUADRILATERALS:
        steps = ((0, 0), (1, 0), (1, 1), (0, 1))
        corners = np.column_stack([(i + di) * len(y) + j + dj for di, dj in steps])
    else:
        corners, region = _union_jack(i, j, corner, len(y)), np.tile(region, 2)
    all_i, all_j = np.indices((len(x), len(y))).reshape(2, -1)
    points = np.column_stack([x[all_i], y[all_j]])
    order = (all_i - corner[0]) % 2 + (all_j - corner[1]) % 2
    return compacted(LinearMesh(points, oriented(points, corners), region, order))


def _union_jack(i: LongArray, j: LongArray, corner: tuple[int, int], columns: int) -> LongArray:
    right, up = (i - corner[0]) % 2, (j - corner[1]) % 2
    even_i, even_j, odd_i, odd_j = i + right, j + up, i + 1 - right, j + 1 - up
    even, odd = even_i * columns + even_j, odd_i * columns + odd_j
    return np.concatenate(
        [np.column_stack([even, odd_i * columns + even_j, odd]),
         np.column_stack([even, even_i * columns + odd_j, odd])]
    )  # fmt: skip


def swept(mesh: LinearMesh, z: FloatArray, regions: LayerRegions, corner: int = 0) -> LinearMesh:
    """Return hexahedra from quadrilaterals, or tetrahedra from triangles, moved along z.

    Every other layer of tetrahedra is cut in the mirrored way.

    Args:
        mesh: plane cells (x, y).
        z: (nz,) levels [m].
        regions: region of the cells of one layer from (regions of the plane cells, its middle z); a
            negative region leaves them out.
        corner: level of a corner of a region, as in `grid`.
    """
    parts, found = [], []
    for layer in range(len(z) - 1):
        region = regions(mesh.regions, 0.5 * (z[layer] + z[layer + 1]))
        for corners in _layer(mesh, layer, (layer - corner) % 2):
            parts.append(corners[region >= 0])
            found.append(region[region >= 0])
    points = np.column_stack([np.tile(mesh.points, (len(z), 1)), np.repeat(z, len(mesh.points))])
    cells = oriented(points, np.concatenate(parts))
    order = np.tile(mesh.order, len(z))
    return compacted(LinearMesh(points, cells, np.concatenate(found), order))


def _layer(mesh: LinearMesh, layer: int, odd: int) -> list[LongArray]:
    """Return the cells between two levels, in groups in the order of the plane cells."""
    count = len(mesh.points)
    if mesh.cells.shape[1] == 4:
        below = mesh.cells + count * layer
        return [np.hstack([below, below + count])]
    order = mesh.order[mesh.cells]
    a, b, c = np.take_along_axis(mesh.cells, np.argsort(order, axis=1), axis=1).T
    low, high = count * (layer + np.array([odd, 1 - odd]))
    prism = [[a + low, b + low, c + low, c + high],
             [a + low, b + low, b + high, c + high],
             [a + low, a + high, b + high, c + high]]  # fmt: skip
    return [np.column_stack(corners) for corners in prism]
