"""The faces of CAD solids as a person sees them: triangles of each, and no mesh of the solids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.cad.assembly import join
from castx.meshes.cad.description import MILLIMETRES, CadPart
from castx.meshes.cad.faces import Face, faces_of
from castx.meshes.cad.healing import mend
from castx.meshes.cad.mould import CHANNEL, extents, named_by_making, with_mould
from castx.meshes.cad.narrow import without_narrow_faces
from castx.meshes.cad.reading import read_solids

FINE = 15
"""Triangles along the longest extent."""
ROUND = 24
"""Triangles round a full circle."""
DELAUNAY = 5
"""gmsh's number of the algorithm on faces, which goes on beside the shortest edges."""
LEAST = 40
"""Smallest ones that roundings ask for, along one of the largest: others would be too many."""


@dataclass(frozen=True)
class SeenPart:
    """Faces of joined solids with their triangles.

    Attributes:
        faces: of the bodies.
        triangles: of each face, (triangles, 3 corners, 3) [m].
        made: numbers of the free faces that have a name by construction, as planes of symmetry.
    """

    faces: tuple[Face, ...]
    triangles: tuple[FloatArray, ...]
    made: Mapping[str, tuple[int, ...]]

    def as_data(self) -> dict[str, Any]:
        """Return the part as lists and texts."""
        rows = [
            {
                "tag": face.tag, "bodies": face.bodies, "area": face.area, "radius": face.radius,
                "centre": face.centre.tolist(), "points": face.points.tolist(),
                "normals": face.normals.tolist(), "triangles": corners.round(7).tolist(),
            }
            for face, corners in zip(self.faces, self.triangles, strict=True)
        ]  # fmt: skip
        return {"faces": rows, "made": {name: list(found) for name, found in self.made.items()}}

    @classmethod
    def of_data(cls, data: Mapping[str, Any]) -> SeenPart:
        """Return the part from the data of `as_data`."""
        faces = tuple(
            Face(
                row["tag"], tuple(row["bodies"]), row["area"], np.array(row["centre"]),
                np.array(row["points"]).reshape(-1, 3), np.array(row["normals"]).reshape(-1, 3),
                row["radius"],
            )
            for row in data["faces"]
        )  # fmt: skip
        triangles = tuple(np.array(row["triangles"]).reshape(-1, 3, 3) for row in data["faces"])
        return cls(faces, triangles, {name: tuple(found) for name, found in data["made"].items()})


def see_part(part: CadPart, scratch: str) -> SeenPart:
    """Return the faces of an assembly, made in the current, empty gmsh model.

    Args:
        part: the assembly; its sizes and selectors do not matter.
        scratch: beginning of the names of files that may be written.

    Raises:
        ValueError: a file or a solid cannot be read or joined, or a face not be drawn.
    """
    solids = read_solids(part.files, part.names, f"{scratch}.brep")
    solids, _ = without_narrow_faces(solids, part.narrowest)
    solids, _ = mend(solids, part.tolerance)
    solids = with_mould(part, solids)
    size = float(np.ptp(extents([solid.tag for solid in solids]), axis=0).max()) / FINE
    drills = [solid.tag for solid in solids if solid.rank == CHANNEL]
    faces = faces_of(join(solids, part.tolerance, drills))
    triangles = _triangles(faces, size * MILLIMETRES)
    number = {face.tag: index for index, face in enumerate(faces)}
    made = {
        name: tuple(number[face.tag] for face in found)
        for name, found in named_by_making(part, faces).items()
    }
    return SeenPart(tuple(faces), tuple(triangles), made)


def _triangles(faces: Sequence[Face], size: float) -> list[FloatArray]:
    """Return the triangles of each face, with a largest size [mm]."""
    gmsh.model.mesh.setSize(gmsh.model.getEntities(0), size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size / LEAST)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", ROUND)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.Algorithm", DELAUNAY)
    try:
        gmsh.model.mesh.generate(2)
    except Exception as error:  # gmsh raises nothing more special
        raise ValueError(
            f"the faces cannot be drawn: {error}; repair them in CAD and export them again"
        ) from None
    tags, places, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    tags, points = tags[order], places.reshape(-1, 3)[order] / MILLIMETRES
    found = []
    for face in faces:
        _, corners = gmsh.model.mesh.getElementsByType(2, face.tag)
        found.append(points[np.searchsorted(tags, corners)].reshape(-1, 3, 3))
    return found
