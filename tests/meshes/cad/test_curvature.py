"""Sizes and cells of curved faces, beside those of a cylinder by hand."""

import math

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.cells import node_points
from castx.meshes.cad.curvature import FILLING, curved_cells, curved_sizes, curved_triangles
from castx.meshes.cad.description import CadFile, CadPart
from castx.meshes.cad.faces import faces_of, inner_parameters

pytestmark = pytest.mark.serial


def test_a_cylinder_asks_for_cells_by_its_radius():
    """Radius 2 mm, height 30 mm, 8 cells round it; its flat ends ask for none."""
    with gmsh_session():
        tag = gmsh.model.occ.addCylinder(0, 0, 0, 0, 0, 30, 2)
        gmsh.model.occ.synchronize()
        faces = faces_of({tag: "pin"})
        part = CadPart((CadFile("a.step"),), 0.01, curvature=8.0)
        round_one = max(faces, key=lambda face: face.area)
        size = 2.0 * math.pi * 0.002 / 8.0
        assert curved_sizes(round_one.tag, inner_parameters(round_one.tag), 8.0) == pytest.approx(
            size, rel=1e-6
        )
        cells, least, place = curved_cells(part, faces)
    assert least == pytest.approx(size, rel=1e-6)
    assert math.hypot(place[0], place[1]) == pytest.approx(0.002, rel=1e-6)
    area = 2.0 * math.pi * 0.002 * 0.03
    assert cells == pytest.approx(area * (size**-2 - 0.01**-2) / 0.8 / FILLING, rel=1e-6)


def test_triangles_of_a_cone_ask_by_their_corners_off_its_tip(monkeypatch):
    """And no parameters are looked for, which takes milliseconds for each point beside a face."""
    monkeypatch.delattr(gmsh.model, "getParametrization")
    with gmsh_session():
        tag = gmsh.model.occ.addCone(0, 0, 0, 0, 0, 30, 0, 10)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 4)
        gmsh.model.mesh.generate(2)
        side = max(faces_of({tag: "cone"}), key=lambda face: face.area)
        nodes = gmsh.model.mesh.getElementsByType(2, side.tag)[1].reshape(-1, 3)
        sizes = curved_triangles(side.tag, nodes, 8.0)
        points = node_points()[nodes.astype(np.int64)]
    heights = np.sort(points[:, :, 2], axis=1)
    radii = heights / 3.0 * math.hypot(1.0, 1.0 / 3.0)  # of curvature, along the normal
    at_tip = heights[:, 0] < 1e-9
    expected = 2.0 * math.pi / 8.0 * radii
    np.testing.assert_allclose(sizes[~at_tip], expected[~at_tip, 1], rtol=1e-6)
    assert at_tip.any() and (sizes[at_tip] > expected[at_tip, 1] * (1.0 - 1e-6)).all()
    assert (sizes[at_tip] < expected[at_tip, 2] * (1.0 + 1e-6)).all()
