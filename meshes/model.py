"""Discrete gmsh models of nodes, cells and named faces.

gmsh is imported where it is used: generators are declared, and cases checked, without it.
"""

from collections.abc import Callable, Sequence

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.meshes.linear_mesh import KINDS, LinearMesh, free_faces

Surface = tuple[str, Callable[[FloatArray], BoolArray]]

LINE = 1
"""gmsh's number of the linear line."""
SYMMETRY = "symmetry-"
"""Beginning of the names of surfaces on planes of symmetry."""


def symmetry_plane(axis: int) -> str:
    """Return the name of the plane of symmetry across a coordinate, by its number."""
    return SYMMETRY + "xyz"[axis]


def plane(name: str, axis: int, value: float, tolerance: float) -> Surface:
    """Return the surface on which one coordinate has a value.

    Args:
        name: of the surface.
        axis: number of the coordinate.
        value: of the coordinate [m].
        tolerance: of the value [m].
    """
    return name, lambda points: np.abs(points[:, axis] - value) < tolerance


def round_surface(name: str, radius: float, tolerance: float) -> Surface:
    """Return the surface round the last axis of a 3-D mesh, or the origin of a 2-D one.

    Args:
        name: of the surface.
        radius: distance from the axis [m].
        tolerance: of the radius [m].
    """
    return name, lambda points: np.abs(np.hypot(points[:, 0], points[:, 1]) - radius) < tolerance


def everything_else(name: str) -> Surface:
    """Return the surface of all other faces."""
    return name, lambda points: np.ones(len(points), dtype=bool)


def base_top_and_outside(up: int, levels: FloatArray, tolerance: float) -> list[Surface]:
    """Return the surfaces base and top at the ends of some levels, and outside, all other faces.

    Args:
        up: number of the coordinate that points up.
        levels: its values, ascending [m].
        tolerance: of the values [m].
    """
    ends = [plane("base", up, levels[0], tolerance), plane("top", up, levels[-1], tolerance)]
    return [*ends, everything_else("outside")]


def fill_model(mesh: LinearMesh, bodies: Sequence[str], surfaces: Sequence[Surface]) -> None:
    """Fill the current gmsh model with a mesh.

    Args:
        mesh: the cells; regions are indices into bodies.
        bodies: names of the physical volumes.
        surfaces: pairs of name and predicate on points; a free face belongs to the first whose
            predicate is true for all its nodes. Faces between two bodies get no name.
    """
    import gmsh

    dim = mesh.dimension
    for region, body in enumerate(bodies):
        cells = mesh.cells[mesh.regions == region]
        nodes = mesh.points if region == 0 else None
        _add_group(dim, region + 1, body, cells, nodes)
    tag = 0
    for name, faces in _named_faces(mesh, surfaces).items():
        tag += 1
        _add_group(dim - 1, tag, name, faces, None)
    gmsh.model.mesh.reclassifyNodes()


def _add_group(dim: int, tag: int, name: str, cells: LongArray, points: FloatArray | None) -> None:
    import gmsh

    gmsh.model.addDiscreteEntity(dim, tag)
    if points is not None:
        coordinates = np.zeros((len(points), 3))
        coordinates[:, : points.shape[1]] = points
        gmsh.model.mesh.addNodes(dim, tag, np.arange(1, len(points) + 1), coordinates.ravel())
    kind = LINE if dim == 1 else KINDS[dim, cells.shape[1]].gmsh
    gmsh.model.mesh.addElementsByType(tag, kind, [], (cells + 1).ravel())
    gmsh.model.addPhysicalGroup(dim, [tag], tag, name=name)


def _named_faces(mesh: LinearMesh, surfaces: Sequence[Surface]) -> dict[str, LongArray]:
    faces = free_faces(mesh)
    left = np.ones(len(faces), dtype=bool)
    named: dict[str, LongArray] = {}
    for name, contains in surfaces:
        taken = left & contains(mesh.points)[faces].all(axis=1)
        left &= ~taken
        if taken.any():
            named[name] = np.concatenate([named.get(name, faces[:0]), faces[taken]])
    return named
