"""The faces of joined solids: bodies on their sides, area, outward normals, radius of curvature."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.description import MILLIMETRES

GRIDS = (7, 25, 80)
"""Points along each parameter of a face, until some lie in it."""
ON_EDGE = 9
"""Points along each edge."""
FLAT = 1e-6
"""Curvature over a length of the face's size that counts as none."""
ROUND = 1e-3
"""Relative variation of a curvature that counts as constant."""


@dataclass(frozen=True)
class Face:
    """A face of the model.

    Args:
        tag: of the surface in the model.
        bodies: on its sides, one or two.
        area: of the CAD face [m²].
        centre: of mass [m].
        points: of its edges and its inside, (points, 3) [m].
        normals: at points of its inside, out of the first body, (points, 3).
        radius: smaller radius of curvature, if it is the same everywhere [m].
    """

    tag: int
    bodies: tuple[str, ...]
    area: float
    centre: FloatArray
    points: FloatArray
    normals: FloatArray
    radius: float | None

    def normals_from(self, body: str) -> FloatArray:
        """Return the normals out of a body."""
        return self.normals if body == self.bodies[0] else -self.normals

    @property
    def text(self) -> str:
        """The face in words."""
        normal = self.normals.mean(axis=0)
        place = ", ".join(f"{x:.4g}" for x in (MILLIMETRES * self.centre).round(6) + 0.0)
        if np.linalg.norm(normal) > 1.0 - 1e-9:
            shape = f"normal ({', '.join(f'{x:.3g}' for x in normal.round(6) + 0.0)})"
        elif self.radius is None:
            shape = "curved"
        else:
            shape = f"radius {MILLIMETRES * self.radius:.4g} mm"
        other = f", touches {self.bodies[1]}" if len(self.bodies) > 1 else ""
        area = f"{1e4 * self.area:.4g} cm²"
        return f"{self.bodies[0]}: {area} around ({place}) mm, {shape}{other}"


def faces_of(volumes: Mapping[int, str]) -> list[Face]:
    """Return the faces of bodies without inner faces of a single body.

    Args:
        volumes: body of each volume of the current gmsh model.
    """
    found = []
    signs = {volume: _orientations(volume) for volume in volumes}
    for _, tag in gmsh.model.getEntities(2):
        above = [int(v) for v in gmsh.model.getAdjacencies(2, tag)[0] if int(v) in volumes]
        bodies = tuple(dict.fromkeys(volumes[v] for v in above))
        if len(bodies) == 2 or len(above) == 1:
            found.append(_face(tag, bodies, signs[above[0]][tag]))
    return found


def _orientations(volume: int) -> dict[int, int]:
    """Return for each face of a volume 1 where its parameters turn about the way out, else -1.

    So a solid knows its inside; to ask of points on which side they lie takes many times as long.
    """
    around = gmsh.model.getBoundary([(3, volume)], combined=False, oriented=True)
    return {abs(tag): 1 if tag > 0 else -1 for _, tag in around}


def _face(tag: int, bodies: tuple[str, ...], orientation: int) -> Face:
    area = gmsh.model.occ.getMass(2, tag)
    parameters = inner_parameters(tag)
    inside = np.reshape(gmsh.model.getValue(2, tag, parameters), (-1, 3))
    normals = np.reshape(gmsh.model.getNormal(tag, parameters), (-1, 3))
    sign = orientation * _turn(tag, parameters, normals)
    return Face(
        tag,
        bodies,
        area / MILLIMETRES**2,
        np.array(gmsh.model.occ.getCenterOfMass(2, tag)) / MILLIMETRES,
        np.concatenate([inside, edge_points(tag)]) / MILLIMETRES,
        sign * normals,
        _radius(tag, parameters, area**0.5),
    )


def inner_parameters(tag: int) -> FloatArray:
    """Return parameters of points inside a face, flat."""
    lowest, highest = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, tag))
    for count in GRIDS:
        steps = (np.arange(count) + 0.5) / count
        grid = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
        candidates = lowest + grid * (highest - lowest)
        kept = [p for p in candidates if gmsh.model.isInside(2, tag, p, parametric=True)]
        if kept:
            return np.concatenate(kept)
    centre = gmsh.model.occ.getCenterOfMass(2, tag)
    return np.array(gmsh.model.getClosestPoint(2, tag, centre)[1])


def edge_points(tag: int) -> FloatArray:
    """Return points of the edges of a face, (points, 3) [mm]."""
    points = [np.empty((0, 3))]
    for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False):
        (first,), (last,) = gmsh.model.getParametrizationBounds(1, edge)
        values = gmsh.model.getValue(1, edge, np.linspace(first, last, ON_EDGE))
        points.append(np.reshape(values, (-1, 3)))
    return np.concatenate(points)


def _turn(tag: int, parameters: FloatArray, normals: FloatArray) -> float:
    """Return 1 if gmsh's normals of a face are those about which its parameters turn, else -1."""
    along = np.reshape(gmsh.model.getDerivative(2, tag, parameters), (-1, 2, 3))
    turning = np.cross(along[:, 0], along[:, 1])
    return 1.0 if float(np.einsum("ij,ij->", turning, normals)) >= 0.0 else -1.0


def _radius(tag: int, parameters: FloatArray, length: float) -> float | None:
    bounds = gmsh.model.getPrincipalCurvatures(tag, parameters)[:2]
    curvature = np.abs(np.array(bounds)).max(axis=0)
    largest = float(curvature.max())
    if largest * length < FLAT or np.ptp(curvature) > ROUND * largest:
        return None
    return 1.0 / largest / MILLIMETRES
