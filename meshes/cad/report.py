"""Sizes of a mesh beside those of the CAD part it was made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.description import MILLIMETRES
from castx.meshes.cad.faces import Face

TRIANGLE, TETRAHEDRON = 2, 4
"""gmsh's numbers of linear cells."""


@dataclass(frozen=True)
class Measure:
    """A volume [m³] or an area [m²].

    Args:
        name: of a body, of a surface as "body/surface", of an interface as "body/body".
        parts: number of solids or faces.
        cad: of the part.
        mesh: of its mesh.
    """

    name: str
    parts: int
    cad: float
    mesh: float


@dataclass(frozen=True)
class Report:
    """What was made of a CAD part.

    Args:
        bodies: with volumes.
        surfaces: named ones, with areas.
        interfaces: with areas.
        remarks: what was mended.
    """

    bodies: tuple[Measure, ...]
    surfaces: tuple[Measure, ...]
    interfaces: tuple[Measure, ...]
    remarks: tuple[str, ...] = ()

    def as_data(self) -> dict[str, Any]:
        """Return it as lists and texts."""
        return asdict(self)

    @classmethod
    def of_data(cls, data: Mapping[str, Any]) -> Report:
        """Return what `as_data` was made of."""
        lists = {key: tuple(Measure(**row) for row in data[key]) for key in MEASURES}
        return cls(**lists, remarks=tuple(data["remarks"]))


MEASURES = ("bodies", "surfaces", "interfaces")


def report_of(
    volumes: Mapping[int, str], faces: Sequence[Face], named: Mapping[str, Sequence[Face]]
) -> Report:
    """Return the sizes of the mesh of the current gmsh model, which is in millimetres.

    Args:
        volumes: body of each volume.
        faces: of the bodies.
        named: faces of each surface.
    """
    points = node_points()
    bodies: dict[str, list[tuple[float, float]]] = {}
    for tag, body in volumes.items():
        cad = gmsh.model.occ.getMass(3, tag) / MILLIMETRES**3
        bodies.setdefault(body, []).append((cad, float(cell_volumes(points, tag).sum())))
    areas = {face.tag: (face.area, float(face_areas(points, face.tag).sum())) for face in faces}
    surfaces: dict[str, list[tuple[float, float]]] = {}
    for name, chosen in named.items():
        for face in chosen:
            surfaces.setdefault(f"{face.bodies[0]}/{name}", []).append(areas[face.tag])
    between: dict[str, list[tuple[float, float]]] = {}
    for face in faces:
        if len(face.bodies) == 2:
            between.setdefault("/".join(sorted(face.bodies)), []).append(areas[face.tag])
    return Report(_measures(bodies), _measures(surfaces), _measures(between))


def _measures(found: Mapping[str, Sequence[tuple[float, float]]]) -> tuple[Measure, ...]:
    return tuple(
        Measure(name, len(rows), sum(cad for cad, _ in rows), sum(mesh for _, mesh in rows))
        for name, rows in found.items()
    )


def node_points() -> FloatArray:
    """Return the coordinates [m] of the nodes of the current gmsh model by tag."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.zeros((int(tags.max(initial=0)) + 1, 3))
    points[tags.astype(np.int64)] = coordinates.reshape(-1, 3) / MILLIMETRES
    return points


def cell_volumes(points: FloatArray, tag: int) -> FloatArray:
    """Return the volumes of the tetrahedra of a volume [m³]."""
    nodes = gmsh.model.mesh.getElementsByType(TETRAHEDRON, tag)[1].astype(np.int64)
    corners = points[nodes.reshape(-1, 4)]
    sides = corners[:, 1:] - corners[:, :1]
    return np.asarray(np.abs(np.linalg.det(sides)) / 6.0)


def face_areas(points: FloatArray, tag: int) -> FloatArray:
    """Return the areas of the triangles of a face [m²]."""
    nodes = gmsh.model.mesh.getElementsByType(TRIANGLE, tag)[1].astype(np.int64)
    corners = points[nodes.reshape(-1, 3)]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(0.5 * np.linalg.norm(cross, axis=1))
