"""Sizes and groups of a mesh, and the refusal of faces that cross each other."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import gmsh
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad import meshing
from castx.meshes.cad.cells import TETRAHEDRON
from castx.meshes.cad.description import CadFile, CadPart, NoCellsError
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.meshing import add_groups, generate, write
from castx.meshes.cad.part import mesh_part
from tests.cad_files import write_cad

pytestmark = pytest.mark.serial


def meshed(part, folder):
    """Mesh all volumes of the model as a body `a`."""
    volumes = {tag: "a" for _, tag in gmsh.model.getEntities(3)}
    generate(part, volumes, faces_of(volumes), {}, str(folder / "sizes"))


def test_size_and_curvature_set_the_number_of_cells(tmp_path):
    counts = []
    for size, curvature in ((0.01, 4.0), (0.005, 4.0), (0.01, 40.0)):
        with gmsh_session():
            gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 20, 10)
            gmsh.model.occ.synchronize()
            meshed(CadPart((CadFile("a.step"),), size, curvature=curvature), tmp_path)
            counts.append(len(gmsh.model.mesh.getElementsByType(TETRAHEDRON)[0]))
    assert counts[1] > 3 * counts[0] and counts[2] > 3 * counts[0]


def test_the_file_is_in_metres(tmp_path):
    with gmsh_session():
        box = gmsh.model.occ.addBox(0, 0, 0, 20, 10, 30)
        gmsh.model.occ.synchronize()
        add_groups({box: "casting"}, {})
        meshed(CadPart((CadFile("a.step"),), 0.02), tmp_path)
        write(str(tmp_path / "a.msh"))
    with gmsh_session():
        gmsh.merge(str(tmp_path / "a.msh"))
        points = gmsh.model.mesh.getNodes()[1].reshape(-1, 3)
        assert points.max(axis=0).tolist() == [0.02, 0.01, 0.03]
        assert gmsh.model.getPhysicalName(3, 1) == "casting"


def test_bodies_are_named_anew():
    """Not beside their old names, of which one would be without a number."""
    with gmsh_session():
        first, second = (gmsh.model.occ.addBox(0, 0, z, 1, 1, 1) for z in (0, 2))
        gmsh.model.occ.synchronize()
        add_groups({first: "a", second: "b"}, {})
        add_groups({second: "b", first: "a"}, {})
        names = {
            tuple(gmsh.model.getEntitiesForPhysicalGroup(3, tag)): gmsh.model.getPhysicalName(
                3, tag
            )
            for _, tag in gmsh.model.getPhysicalGroups()
        }
    assert names == {(first,): "a", (second,): "b"}


def test_faces_that_cross_are_refused(tmp_path):
    with gmsh_session():
        occ = gmsh.model.occ
        corners = [(0, 0, 0), (20, 0, 0), (20, 20, 0), (0, 20, 0), (8, 8, 30)]
        inner = [(5, 5, -5), (15, 5, -5), (10, 15, -5), (10, 9, 10)]
        volumes = []
        for places, faces in (
            (corners, [(0, 1, 2, 3), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]),
            (inner, [(0, 1, 2), (0, 1, 3), (1, 2, 3), (2, 0, 3)]),
        ):
            points = [occ.addPoint(*place) for place in places]
            lines: dict[tuple[int, int], int] = {}
            loops = []
            for face in faces:
                edges = []
                for a, b in zip(face, face[1:] + face[:1], strict=True):
                    key = (min(a, b), max(a, b))
                    if key not in lines:
                        lines[key] = occ.addLine(points[a], points[b])
                    edges.append(lines[key])
                loops.append(occ.addPlaneSurface([occ.addCurveLoop(edges)]))
            volumes.append(loops)
        occ.addVolume([occ.addSurfaceLoop(volumes[0]), occ.addSurfaceLoop(volumes[1])])
        occ.synchronize()
        with pytest.raises(ValueError, match=r"gmsh cannot mesh the solids: .*CAD"):
            meshed(CadPart((CadFile("a.step"),), 0.01), tmp_path)
        gmsh.clear()  # and gmsh is ready for the next model
        occ.addBox(0, 0, 0, 10, 10, 10)
        occ.synchronize()
        meshed(CadPart((CadFile("a.step"),), 0.01), tmp_path)
        assert gmsh.model.mesh.getElementsByType(TETRAHEDRON)[0].size > 5


def test_a_wall_that_needs_too_many_cells_is_refused_with_its_place_or_taken_as_it_comes(tmp_path):
    """A pocket of 10 x 6 mm leaves 0.6 mm to the side of a block of 120 mm."""

    def thin(occ):
        block, pocket = occ.addBox(0, 0, 0, 120, 40, 10), occ.addBox(0.6, 15, 4, 9, 10, 7)
        ((_, part),), _ = occ.cut([(3, block)], [(3, pocket)])
        return [part]

    path = write_cad(tmp_path / "thin.step", thin)
    part = CadPart((CadFile(str(path)),), 0.01, across=1, curvature=8.0, most_cells=2e4)
    text = r"most_cells allows 2.0e\+04: round \(\S+, 0.0[12]\d*, \S+\) m a wall.*across = 0"
    with gmsh_session(), pytest.raises(ValueError, match=text):
        mesh_part(part, str(tmp_path / "thin.msh"))
    with gmsh_session():
        report = mesh_part(replace(part, across=0), str(tmp_path / "thin.msh"))
    assert report.quality.cells < 5000
    assert report.bodies[0].mesh == pytest.approx(report.bodies[0].cad, rel=0.05)


def test_faces_whose_cells_cross_are_meshed_with_other_cells(tmp_path, monkeypatch):
    """A cup with a boss and a rib: the better cells of its faces overlap in one plane."""

    def cup(occ):
        outside, inside = (
            occ.addCylinder(0, 0, 0, 0, 0, 24, 52),
            occ.addCylinder(0, 0, -1, 0, 0, 17, 44),
        )
        shell, _ = occ.cut([(3, outside)], [(3, inside)])
        rib = occ.addBox(15, -4, 6, 33, 8, 14)
        occ.rotate([(3, rib)], 0, 0, 0, 0, 0, 1, pi / 4)
        boss = occ.addCylinder(0, 0, 0, 0, 0, 40, 22)
        filled, _ = occ.fuse(shell, [(3, boss), (3, rib)])
        ((_, part),), _ = occ.cut(filled, [(3, occ.addCylinder(0, 0, -1, 0, 0, 50, 12))])
        return [part]

    path = write_cad(tmp_path / "cup.step", cup)
    part = CadPart((CadFile(str(path)),), 0.017, across=1, curvature=8.0)
    with gmsh_session():
        report = mesh_part(part, str(tmp_path / "cup.msh"))
    assert report.quality.cells > 500
    assert report.bodies[0].mesh == pytest.approx(report.bodies[0].cad, rel=0.05)
    monkeypatch.setattr(meshing, "MESHADAPT", meshing.FRONTAL)
    with gmsh_session(), pytest.raises(NoCellsError, match=r"the solids: .*elements in"):
        mesh_part(part, str(tmp_path / "cup.msh"))
