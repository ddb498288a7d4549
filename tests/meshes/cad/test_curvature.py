"""Sizes and cells of curved faces, beside those of a cylinder by hand."""

import math

import gmsh
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.curvature import FILLING, curved_cells, curved_sizes
from castx.meshes.cad.description import CadFile, CadPart
from castx.meshes.cad.faces import faces_of

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
        assert curved_sizes(round_one.tag, round_one.points, 8.0) == pytest.approx(size, rel=1e-6)
        cells, least, place = curved_cells(part, faces)
    assert least == pytest.approx(size, rel=1e-6)
    assert math.hypot(place[0], place[1]) == pytest.approx(0.002, rel=1e-6)
    area = 2.0 * math.pi * 0.002 * 0.03
    assert cells == pytest.approx(area * (size**-2 - 0.01**-2) / 0.8 / FILLING, rel=1e-6)
