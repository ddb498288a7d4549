"""Cells of the mesh of the current gmsh model: volumes, areas of faces, quality."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import gmsh
import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.cad.description import MILLIMETRES

TRIANGLE, TETRAHEDRON = 2, 4
"""gmsh's numbers of linear cells."""
CORNERS = {TRIANGLE: 3, TETRAHEDRON: 4}
"""Of each kind."""
POOR = 0.1
"""Quality below which a cell counts as poor."""


@dataclass(frozen=True)
class Quality:
    """Inscribed over circumscribed radius of cells, 1 in a regular one.

    Args:
        cells: their number.
        mean: of all cells.
        worst: of the worst one.
        place: of the worst one [m].
        poor: number of cells below `POOR`.
        shortest: edge [m].
        longest: edge [m].
    """

    cells: int
    mean: float
    worst: float
    place: tuple[float, float, float]
    poor: int
    shortest: float
    longest: float

    @classmethod
    def of_data(cls, data: Mapping[str, Any]) -> Quality:
        """Return the object from its entries by name."""
        return cls(**{**data, "place": tuple(data["place"])})


def solid_volumes(volumes: Mapping[int, str]) -> dict[str, tuple[int, float]]:
    """Return the number of solids of each body and their volume [m³].

    Args:
        volumes: body of each volume of the current gmsh model.
    """
    found: dict[str, tuple[int, float]] = {}
    for tag, body in volumes.items():
        count, volume = found.get(body, (0, 0.0))
        found[body] = count + 1, volume + gmsh.model.occ.getMass(3, tag) / MILLIMETRES**3
    return found


def node_points() -> FloatArray:
    """Return the coordinates [m] of the nodes of the current gmsh model by tag."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(tags.max(initial=0)) + 1, 3))
    points[tags.astype(np.int64)] = coordinates.reshape(-1, 3) / MILLIMETRES
    return points


def corners_of(kind: int, tag: int) -> LongArray:
    """Return the tags of the nodes of the cells of an entity, (cells, corners).

    Args:
        kind: `TRIANGLE` or `TETRAHEDRON`.
        tag: of a face or of a volume.
    """
    nodes = gmsh.model.mesh.getElementsByType(kind, tag)[1]
    return np.asarray(nodes, dtype=np.int64).reshape(-1, CORNERS[kind])


def cell_volumes(points: FloatArray, tag: int) -> FloatArray:
    """Return the volumes of the tetrahedra of a volume [m³]."""
    return tetrahedron_volumes(points[corners_of(TETRAHEDRON, tag)])


def tetrahedron_volumes(corners: FloatArray) -> FloatArray:
    """Return the volumes of tetrahedra with these corners (tetrahedra, 4, 3) [m³]."""
    sides = corners[:, 1:] - corners[:, :1]
    return np.asarray(np.abs(np.linalg.det(sides)) / 6.0)


def face_areas(points: FloatArray, tag: int) -> FloatArray:
    """Return the areas of the triangles of a face [m²]."""
    corners = points[corners_of(TRIANGLE, tag)]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(0.5 * np.linalg.norm(cross, axis=1))


def cell_qualities(volumes: Sequence[int]) -> tuple[FloatArray, FloatArray]:
    """Return corners (cells, 4, 3) [m] and qualities of the cells of the current gmsh model.

    Args:
        volumes: their tags.
    """
    points = node_points()
    tags, nodes = [], []
    for volume in volumes:
        found = gmsh.model.mesh.getElementsByType(TETRAHEDRON, volume)
        tags.append(found[0])
        nodes.append(found[1].reshape(-1, 4).astype(np.int64))
    values = gmsh.model.mesh.getElementQualities(np.concatenate(tags), "gamma")
    return points[np.concatenate(nodes)], np.asarray(values, dtype=np.float64)


def quality_of(corners: FloatArray, qualities: FloatArray) -> Quality:
    """Return the statistics of cells.

    Args:
        corners: (cells, 4, 3) [m].
        qualities: of the cells.
    """
    first, second = np.triu_indices(4, 1)
    edges = np.linalg.norm(corners[:, first] - corners[:, second], axis=2)
    worst = int(np.argmin(qualities))
    x, y, z = map(float, corners[worst].mean(axis=0))
    return Quality(
        len(qualities),
        float(qualities.mean()),
        float(qualities[worst]),
        (x, y, z),
        int(np.count_nonzero(qualities < POOR)),
        float(edges.min()),
        float(edges.max()),
    )
