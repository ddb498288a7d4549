"""Faces of CAD solids with triangles, without a mesh of the solids."""

import json

import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.description import CadFile, CadPart, SymmetryPlane
from castx.meshes.cad.seen import SeenPart, see_part
from tests.cad_files import rounded_block, two_blocks, write_cad

pytestmark = pytest.mark.serial


def area(triangles):
    sides = triangles[:, 1:] - triangles[:, :1]
    return 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()


def test_each_face_has_its_triangles(tmp_path):
    path = write_cad(tmp_path / "two.step", two_blocks, ["casting", "die"])
    cut = SymmetryPlane(axis=1, place=0.005, above=True)
    with gmsh_session():
        seen = see_part(CadPart((CadFile(str(path)),), 1.0, symmetry=(cut,)), str(tmp_path / "x"))
    seen = SeenPart.of_data(json.loads(json.dumps(seen.as_data())))
    for face, triangles in zip(seen.faces, seen.triangles, strict=True):
        assert area(triangles) == pytest.approx(face.area, rel=1e-5)
    shared = [face for face in seen.faces if len(face.bodies) == 2]
    assert len(shared) == 1 and set(shared[0].bodies) == {"casting", "die"}
    at_cut = [seen.faces[number] for number in seen.made["symmetry-y"]]
    assert len(at_cut) == 2
    for face in at_cut:
        assert face.points[:, 1] == pytest.approx(0.005)
        assert face.normals_from(face.bodies[0])[:, 1] == pytest.approx(-1.0)


def test_the_finest_roundings_ask_for_no_more_triangles_than_coarse_ones(tmp_path):
    """Rounded by 0.01 mm, this block once took more than a minute and a half."""
    counts = []
    for radius in (4.0, 0.01):
        path = write_cad(tmp_path / f"{radius}.step", lambda occ, r=radius: rounded_block(occ, r))
        with gmsh_session():
            seen = see_part(CadPart((CadFile(str(path)),), 1.0), str(tmp_path / "x"))
        counts.append(sum(len(triangles) for triangles in seen.triangles))
        for face, triangles in zip(seen.faces, seen.triangles, strict=True):
            assert area(triangles) == pytest.approx(face.area, rel=0.2)
    assert counts[1] < 4 * counts[0]


def test_what_is_left_out_of_the_mesh_is_not_seen_either(tmp_path):
    path = write_cad(tmp_path / "a.step", rounded_block)
    counts = []
    for narrowest in (0.0, 0.005):
        part = CadPart((CadFile(str(path)),), 1.0, narrowest=narrowest)
        with gmsh_session():
            counts.append(len(see_part(part, str(tmp_path / "x")).faces))
    assert counts == [10, 6]
