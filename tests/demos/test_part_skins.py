"""Triangles on the faces of the parts: areas of interfaces and volumes enclosed, beside CAD.

They are read from STEP as castx reads them. A circle of n sides lacks 1 - sin(2π/n)/(2π/n) of its
area, 7.1e-4 with 96 sides; polyhedra lack nothing.
"""

from __future__ import annotations

from collections import defaultdict
from math import pi, sin

import gmsh
import numpy as np
import pytest

from castx.meshes.cad.assembly import join
from castx.meshes.cad.cells import face_areas, node_points, solid_volumes
from castx.meshes.cad.description import MILLIMETRES, CadFile
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.healing import mend
from castx.meshes.cad.reading import read_solids
from demos.parts import block, bracket, housing, lug, wheel
from demos.parts.assembly import write_step
from demos.parts.solids import drawing

pytestmark = pytest.mark.serial

PARTS = {
    "lug": (lambda: lug.lug(lug.Lug()), 96),
    "bracket": (lambda: bracket.bracket(bracket.Bracket()), 24),
    "wheel": (lambda: wheel.wheel(wheel.Wheel(spokes=2, half=1)), 24),
    "housing": (lambda: housing.housing(housing.Housing()), 24),
    "block": (lambda: block.block(block.Block(cylinders=1)), 24),
}
TOLERANCE = 1e-6


def missing(sides):
    """Return the share of the area of a circle that a polygon of so many sides lacks."""
    return 1.0 - sin(2 * pi / sides) / (2 * pi / sides)


def triangulated(name, sides, folder):
    """Read a part from its STEP file and mesh its faces; return bodies of solids and faces."""
    write_step(PARTS[name][0](), folder / f"{name}.step")
    file = CadFile(str(folder / f"{name}.step"))
    gmsh.model.add("read")
    solids, _ = mend(read_solids([file], {}, str(folder / "sewn.brep")), TOLERANCE)
    volumes = join(solids, TOLERANCE)
    gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 40.0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 40.0)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", sides)
    gmsh.model.mesh.generate(2)
    return volumes, faces_of(volumes)


def enclosed(points, solid):
    """Return the volume inside the triangles of a solid [m³], by the divergence theorem."""
    total = 0.0
    for _, face in gmsh.model.getBoundary([(3, solid)], oriented=False):
        nodes = gmsh.model.mesh.getElementsByType(2, face)[1].astype(np.int64)
        corners = points[nodes.reshape(-1, 3)]
        total += outward(solid, corners) * np.linalg.det(corners).sum() / 6.0
    return total


def outward(solid, corners):
    """Return 1 if the triangles of a face point out of a solid, -1 if they point into it."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    k = int(np.argmax(lengths))
    ahead = corners[k].mean(axis=0) + 0.2 * normals[k] / np.sqrt(lengths[k])
    return -1 if gmsh.model.isInside(3, solid, list(ahead * MILLIMETRES)) else 1


def is_polygon(face):
    edges = gmsh.model.getBoundary([(2, face)], oriented=False)
    straight = all(gmsh.model.getType(1, abs(tag)) == "Line" for _, tag in edges)
    return straight and gmsh.model.getType(2, face) == "Plane"


@pytest.mark.sampled
@pytest.mark.parametrize("name", PARTS)
def test_interfaces_and_volumes_are_those_of_cad(name, tmp_path):
    sides = PARTS[name][1]
    with drawing(name):
        volumes, faces = triangulated(name, sides, tmp_path)
        points = node_points()
        shared, polygons = defaultdict(lambda: np.zeros(2)), 0
        for face in faces:
            area = face_areas(points, face.tag).sum()
            shared[face.bodies] += (face.area, area)
            if is_polygon(face.tag):
                polygons += 1
                assert area == pytest.approx(face.area, rel=1e-10)
        inside = defaultdict(float)
        for solid, body in volumes.items():
            inside[body] += enclosed(points, solid)
        drawn = solid_volumes(volumes)
    assert polygons >= 4
    for bodies, (cad, mesh) in shared.items():
        assert mesh == pytest.approx(cad, rel=missing(sides) + 1e-10), bodies
    for body, volume in inside.items():
        assert volume == pytest.approx(drawn[body][1], rel=missing(sides)), body
