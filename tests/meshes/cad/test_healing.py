"""Edges and faces that mean nothing are mended or refused, with place and size."""

from __future__ import annotations

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.assembly import join
from castx.meshes.cad.cells import cell_qualities
from castx.meshes.cad.description import CadFile, CadPart
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.healing import details, mend, refuse_flat_cells, refuse_small
from castx.meshes.cad.meshing import generate
from castx.meshes.cad.part import mesh_part
from castx.meshes.cad.reading import Solid
from tests.cad_files import two_blocks, write_cad

pytestmark = pytest.mark.serial


def with_a_tiny_face(occ, width=5e-4):
    """A block of 20 x 10 x 10 of which one upright edge is a face of a width, times √2."""
    places = ((0, 0), (20, 0), (20, 10), (20 - width, 10 + width), (0, 10))
    points = [occ.addPoint(x, y, 0) for x, y in places]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    base = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    return [tag for dim, tag in occ.extrude([(2, base)], 0, 0, 10) if dim == 3]


def test_the_poles_of_a_ball_are_no_edges():
    with gmsh_session():
        ball = gmsh.model.occ.addSphere(0, 0, 0, 10)
        gmsh.model.occ.synchronize()
        assert sorted(detail.what for detail in details([ball])) == ["edge", "face"]


def test_a_face_below_the_tolerance_is_mended_with_its_neighbours(tmp_path):
    with gmsh_session():
        (tag,) = with_a_tiny_face(gmsh.model.occ)
        other = gmsh.model.occ.addBox(50, 0, 0, 5, 5, 5)
        gmsh.model.occ.synchronize()
        assert details([tag])[0].width == pytest.approx(7.07e-7, rel=1e-3)
        solids, remarks = mend([Solid(tag, "casting", "a"), Solid(other, "die", "b")], 1e-6)
        assert [solid.name for solid in solids] == ["casting", "die"]
        (remark,) = remarks
        assert remark.startswith(
            "casting: 3 edges and faces below geometry.tolerance, 1e-06 m, men"
        )
        assert [len(gmsh.model.getEntities(dim)) for dim in range(4)] == [16, 24, 12, 2]
        assert all(
            len(gmsh.model.getAdjacencies(dim, tag)[0])
            for dim in range(3)
            for _, tag in gmsh.model.getEntities(dim)
        )
        refuse_small([solid.tag for solid in solids], 1e-6)
        volumes = [gmsh.model.occ.getMass(3, solid.tag) for solid in solids]
        assert volumes == pytest.approx([2000.0, 125.0], rel=1e-4)
        bodies = {solid.tag: solid.name for solid in solids}
        generate(CadPart((), 0.005), bodies, faces_of(bodies), {}, str(tmp_path / "sizes"))


def test_what_is_left_below_the_tolerance_is_refused_with_place_and_size():
    with gmsh_session():
        (tag,) = with_a_tiny_face(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        text = (
            r"the face at \(0.02, 0.01, 0.005\) m is 7.1e-07 m wide \(and 2 others\), less than "
            "geometry.tolerance, 1e-06 m, and cannot be mended"
        )
        with pytest.raises(ValueError, match=text):
            refuse_small([tag], 1e-6)


def test_bodies_that_miss_each_other_a_little_are_refused_as_flat_cells(tmp_path):
    with gmsh_session():
        tags = two_blocks(gmsh.model.occ, (0.01, 0.003, 0.0))
        gmsh.model.occ.synchronize()
        volumes = join([Solid(tags[0], "a", ""), Solid(tags[1], "b", "")], 1e-6)
        generate(CadPart((), 0.005), volumes, faces_of(volumes), {}, str(tmp_path / "sizes"))
        corners, qualities = cell_qualities(list(volumes))
        text = r"cells are flat, the worst at \(.*the face at .* is 3e-06 m wide. Raise geometry"
        text = rf"^{np.sum(qualities < 0.002)} {text}"
        with pytest.raises(ValueError, match=text):
            refuse_flat_cells(list(volumes), corners.mean(axis=1), qualities)
        refuse_flat_cells(list(volumes), corners.mean(axis=1), np.maximum(qualities, 0.01))


@pytest.mark.parametrize("shift", [(0.01, 0.003, -0.01), (0.01, 0.003, 0.01)])
def test_a_shift_of_a_hundredth_is_meshed_with_its_tolerance(tmp_path, shift):
    path = write_cad(tmp_path / "two.step", lambda occ: two_blocks(occ, shift), ["a", "b"])
    with gmsh_session():
        part = CadPart((CadFile(str(path)),), 0.005, tolerance=2e-5)
        report = mesh_part(part, str(tmp_path / "two.msh"))
    assert report.quality.worst > 0.1
    for body, volume in zip(report.bodies, (4e-6, 6e-6), strict=True):
        assert body.cad == pytest.approx(volume, rel=1e-12)  # as drawn, before it was joined
        assert body.mesh == pytest.approx(volume, rel=2e-3)
