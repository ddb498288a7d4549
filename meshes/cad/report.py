"""Sizes of a mesh beside those of the CAD part it was made of."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.cells import (
    TETRAHEDRON,
    Quality,
    cell_volumes,
    corners_of,
    face_areas,
    node_points,
)
from castx.meshes.cad.description import Box
from castx.meshes.cad.faces import Face


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
    """Report on a CAD part: bodies, interfaces, surfaces, quality of the mesh.

    Args:
        bodies: with volumes.
        surfaces: named ones, with areas.
        interfaces: with areas.
        quality: of the cells.
        extent: the longest one of the part [m].
        size: the largest one that was asked for [m].
        remarks: what was mended.
        boxes: lowest and highest corner of the mesh of each body [m].
    """

    bodies: tuple[Measure, ...]
    surfaces: tuple[Measure, ...]
    interfaces: tuple[Measure, ...]
    quality: Quality
    extent: float = 0.0
    size: float = 0.0
    remarks: tuple[str, ...] = ()
    boxes: Mapping[str, Box] = field(default_factory=dict)

    def as_data(self) -> dict[str, Any]:
        """Return the report as lists and texts."""
        return asdict(self)

    @classmethod
    def of_data(cls, data: Mapping[str, Any]) -> Report:
        """Return the report from the data of `as_data`."""
        lists = {key: tuple(Measure(**row) for row in data[key]) for key in MEASURES}
        return cls(
            **lists,
            quality=Quality.of_data(data["quality"]),
            extent=data["extent"],
            size=data["size"],
            remarks=tuple(data["remarks"]),
            boxes={name: (tuple(low), tuple(high)) for name, (low, high) in data["boxes"].items()},
        )


MEASURES = ("bodies", "surfaces", "interfaces")


def report_of(
    volumes: Mapping[int, str],
    drawn: Mapping[str, tuple[int, float]],
    faces: Sequence[Face],
    named: Mapping[str, Sequence[Face]],
    quality: Quality,
    remarks: Sequence[str] = (),
    carved: Collection[str] = (),
) -> Report:
    """Return the sizes of the mesh of the current gmsh model, which is in millimetres.

    Args:
        volumes: body of each volume.
        drawn: number and volume of the solids of each body in CAD [m³].
        faces: of the bodies.
        named: faces of each surface.
        quality: of the cells.
        remarks: what was mended.
        carved: bodies that are as large as their mesh, since no CAD solid has their shape.
    """
    points = node_points()
    meshed = dict.fromkeys(drawn, 0.0)
    for tag, body in volumes.items():
        meshed[body] += float(cell_volumes(points, tag).sum())
    bodies = tuple(
        Measure(name, count, meshed[name] if name in carved else volume, meshed[name])
        for name, (count, volume) in drawn.items()
    )
    areas = {face.tag: (face.area, float(face_areas(points, face.tag).sum())) for face in faces}
    surfaces: dict[str, list[tuple[float, float]]] = {}
    for name, chosen in named.items():
        for face in chosen:
            surfaces.setdefault(f"{face.bodies[0]}/{name}", []).append(areas[face.tag])
    between: dict[str, list[tuple[float, float]]] = {}
    for face in faces:
        if len(face.bodies) == 2:
            between.setdefault("/".join(sorted(face.bodies)), []).append(areas[face.tag])
    return Report(
        bodies, _measures(surfaces), _measures(between), quality,
        remarks=tuple(remarks), boxes={name: _box(name, volumes, points) for name in drawn},
    )  # fmt: skip


def _box(body: str, volumes: Mapping[int, str], points: FloatArray) -> Box:
    """Return lowest and highest corner of the cells of a body [m], by the points of all nodes."""
    tags = [tag for tag, owner in volumes.items() if owner == body]
    found = points[np.concatenate([corners_of(TETRAHEDRON, tag) for tag in tags])]
    low, high = np.round(found.min(axis=(0, 1)), 9), np.round(found.max(axis=(0, 1)), 9)
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _measures(found: Mapping[str, Sequence[tuple[float, float]]]) -> tuple[Measure, ...]:
    return tuple(
        Measure(name, len(rows), sum(cad for cad, _ in rows), sum(mesh for _, mesh in rows))
        for name, rows in found.items()
    )
