"""The surface of a distorted body, and that of the mould which makes up for the distortion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyvista
from scipy.spatial import cKDTree

from castx.arrays import FloatArray, LongArray
from castx.domain.source import write_moved
from castx.errors import CaseError
from castx.foundry.distortion import best_fit, compensated
from castx.handover.body_state import BodyState
from castx.handover.following import FACES, followed
from castx.results.reading import cells_of
from castx.results.sunk_shape import simplices, without_pipe

MILLIMETRE = 1e-3
PLACE = "place"
"""Array of where nodes are, along which a cut goes."""
SAME_PLACE = 1e-6
"""Distance of nodes, beside the extent of the body, below which they are the same."""


def outer_triangles(points: FloatArray, cells: LongArray) -> LongArray:
    """Return the surface of solid cells as triangles with outward normals, (triangles, 3).

    Args:
        points: of the nodes, (nodes, 3) [m].
        cells: tetrahedra or hexahedra in the order of VTK, (cells, corners).
    """
    faces = cells[:, FACES[cells.shape[1]]]
    owner = np.repeat(np.arange(len(cells)), faces.shape[1])
    faces = faces.reshape(-1, faces.shape[2])
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    outer = np.sort(first[count == 1])
    faces, owner = faces[outer], owner[outer]
    corners = points[faces]
    # The diagonals of a quadrilateral, two edges of a triangle.
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    if faces.shape[1] == 3:
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    away = corners.mean(axis=1) - points[cells[owner]].mean(axis=1)
    inward = np.einsum("fi,fi->f", normal, away) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    if faces.shape[1] == 3:
        return faces
    return np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])


def distorted(state: BodyState, fit: bool = False) -> FloatArray:
    """Return where the nodes of a body are, (nodes, 3) [m].

    Args:
        state: the body at a moment.
        fit: remove the rigid motion that comes nearest to the motion of the surface.

    Raises:
        CaseError: the displacement was not written.
    """
    return _fitted(state, state.points, fit)


def sunk(state: BodyState, places: FloatArray) -> tuple[FloatArray, LongArray]:
    """Return nodes and cells of a body without its pipe, (nodes, 3) [m] and (cells, corners).

    Args:
        state: the body at a moment.
        places: of its nodes, (nodes, 3) [m].
    """
    grid = state.grid.copy()
    grid.point_data[PLACE] = places
    left = without_pipe(grid, state.model)
    if left is grid:
        return places, state.cells
    cut = simplices(left)
    return np.asarray(cut[PLACE], dtype=np.float64), cells_of(cut)


def compensated_mould(
    state: BodyState, nominal: BodyState | None = None, fit: bool = False
) -> FloatArray:
    """Return the next places of the nodes of a mould cavity, X - (x - X_nominal), (nodes, 3) [m].

    A free shrinkage e leaves e² after the first and e³ after the second time.

    Args:
        state: the body as it is cast in the present mould.
        nominal: the body of the first run, whose mesh is the part as it should be; None: the
            present mesh is.
        fit: remove the rigid motion from the nominal part that comes nearest.

    Raises:
        CaseError: the displacement was not written, or both meshes are not of the same cells.
    """
    wanted = state.points if nominal is None else nominal.points
    if nominal is not None and not np.array_equal(nominal.cells, state.cells):
        raise CaseError(
            f"the nominal body and {state.name!r} do not have the same cells; run the compensated "
            "mesh (castx export --to mould --mesh) on as many ranks as the nominal one"
        )
    return compensated(state.points, _fitted(state, wanted, fit), wanted)


def write_surface(path: Path, points: FloatArray, cells: LongArray) -> bool:
    """Write the surface of a body as STL in millimetres, and return whether it is closed.

    Args:
        path: of the file.
        points: of the nodes, (nodes, 3) [m].
        cells: tetrahedra or hexahedra in the order of VTK, (cells, corners).

    Raises:
        CaseError: the file is no STL, the body is not in space, or the disk does not take it.
    """
    if path.suffix.lower() != ".stl":
        raise CaseError(f"a surface is written as .stl, and {path} is none")
    if cells.shape[1] < 4 or not np.ptp(points[:, 2]):
        raise CaseError('a surface is written of bodies in space alone, geometry.model = "3d"')
    triangles = outer_triangles(points, cells)
    used, numbers = np.unique(triangles, return_inverse=True)
    places: Any = points[used] / MILLIMETRE
    faces: Any = numbers.reshape(-1, 3)
    surface = pyvista.PolyData.from_regular_faces(places, faces)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        surface.save(path)
    except OSError as error:
        raise CaseError(f"cannot write {path}: {error.strerror}") from error
    return bool(surface.n_open_edges == 0)


def write_mould_mesh(path: Path, state: BodyState, places: FloatArray, mesh: Path) -> None:
    """Write a mesh whose nodes in a body are moved, and those of other bodies follow.

    Surfaces of other bodies that do not touch the body stay where they are.

    Args:
        path: of the file, .msh.
        state: the body.
        places: of its nodes, (nodes, 3) [m].
        mesh: on which it was computed, as castx mesh writes it.

    Raises:
        CaseError: the nodes of the mesh are others than those of the body.
        MeshError: the mesh cannot be read or written, or cells would be turned over.
    """

    def moved(nodes: FloatArray, cells: list[LongArray]) -> FloatArray:
        extent = float(np.ptp(state.points, axis=0).max())
        distance, found = cKDTree(nodes).query(state.points)
        if distance.max() > SAME_PLACE * extent:
            raise CaseError(
                f"{mesh} is not the mesh of {state.results.folder}: it has no node at "
                f"{state.points[distance.argmax()].tolist()} m"
            )
        return followed(nodes, cells, found, places - state.points)

    write_moved(mesh, path, moved)


def _fitted(state: BodyState, nominal: FloatArray, fit: bool) -> FloatArray:
    places = state.points + state.displacement
    if not fit:
        return places
    triangles = outer_triangles(nominal, state.cells) if state.model == "3d" else None
    if triangles is None:
        raise CaseError('the best fit is of bodies in space alone, geometry.model = "3d"')
    corners = nominal[triangles]
    sizes = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    areas: FloatArray = np.zeros(len(nominal))
    np.add.at(areas, triangles, sizes[:, None])
    targets, moved = nominal, places
    for normal, offset in state.planes:
        targets = np.concatenate([targets, _image(targets, normal, offset)])
        moved = np.concatenate([moved, _image(moved, normal, offset)])
        areas = np.concatenate([areas, areas])
    return best_fit(targets, moved, areas).removed(places)


def _image(points: FloatArray, normal: FloatArray, offset: float) -> FloatArray:
    return np.asarray(points - 2.0 * (points @ normal - offset)[:, None] * normal)
