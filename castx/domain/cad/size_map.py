"""Files with sizes of cells over space: VTU, tetrahedra with the sizes at their points."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.errors import MeshError
from castx.meshes.cad.description import SizeMap

SIZE = "size"
"""Name of the values in the file."""
TETRAHEDRON = "tetra"
"""meshio's name of the cells."""


def read_size_map(path: Path, finer: float) -> SizeMap:
    """Return the sizes of a file; call it on one rank only.

    Args:
        path: of the file.
        finer: by which its sizes are divided.

    Raises:
        MeshError: it cannot be read, has other cells or no sizes, or one is not positive.
    """
    named = f"geometry.size_map {path}"
    if not path.is_file():
        raise MeshError(f"{named}: there is no such file")
    try:
        mesh = meshio.read(path)
    except (Exception, SystemExit) as error:  # meshio raises whatever it meets, and exits
        raise MeshError(f"{named}: meshio says: {type(error).__name__}: {error}") from None
    cells = mesh.cells_dict.get(TETRAHEDRON)
    if cells is None or SIZE not in mesh.point_data:
        raise MeshError(f"{named}: tetrahedra with the values {SIZE!r} at their points are needed")
    values = np.asarray(mesh.point_data[SIZE], dtype=np.float64)
    if values.ndim != 1 or not np.all(np.isfinite(values) & (values > 0.0)):
        raise MeshError(f"{named}: each {SIZE!r} must be one positive length [m]")
    return SizeMap(np.asarray(mesh.points)[cells], values[cells] / finer)


def write_size_map(path: Path, points: FloatArray, cells: LongArray, sizes: FloatArray) -> None:
    """Write sizes as a VTU file.

    Args:
        path: of the file, which ends with .vtu.
        points: (points, 3) [m].
        cells: points of the tetrahedra, (cells, 4).
        sizes: at the points, (points,) [m].
    """
    meshio.Mesh(points, [(TETRAHEDRON, cells)], point_data={SIZE: sizes}).write(path)
