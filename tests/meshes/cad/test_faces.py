"""Faces know their bodies, areas, outward normals and radii."""

from __future__ import annotations

from math import pi

import gmsh
import numpy as np
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.assembly import join
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.reading import Solid
from tests.cad_files import bush_in_ring, rounded_block, two_blocks

pytestmark = pytest.mark.serial


def faces(solids, *names):
    with gmsh_session():
        tags = solids(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        made = [Solid(tag, name, name) for tag, name in zip(tags, names, strict=True)]
        return faces_of(join(made, 0.0))


def test_free_and_shared_faces_of_two_blocks():
    found = faces(two_blocks, "casting", "die")
    shared = [face for face in found if len(face.bodies) == 2]
    assert len(shared) == 1 and set(shared[0].bodies) == {"casting", "die"}
    assert shared[0].normals_from("casting") == pytest.approx(
        np.tile([0, 0, -1.0], (len(shared[0].normals), 1))
    )
    assert len([face for face in found if face.bodies == ("casting",)]) == 5
    assert sum(face.area for face in found if face.bodies == ("die",)) == pytest.approx(18e-4)


def test_area_vectors_of_a_closed_surface_sum_to_zero_and_enclose_the_volume():
    found = faces(rounded_block, "casting")
    planes = [face for face in found if face.radius is None]
    assert len(planes) == 6 and len(found) == 10
    enclosed = sum(face.area * (face.normals @ face.points[: len(face.normals)].T).diagonal().mean()
                   for face in found) / 3  # fmt: skip
    volume = (30 * 20 - (4 - pi) * 16) * 10 * 1e-9
    assert enclosed == pytest.approx(volume, rel=5e-3)


def test_radii_of_fillets_and_of_bores_with_normals_out_of_the_metal():
    radii = [face.radius for face in faces(rounded_block, "a") if face.radius is not None]
    assert radii == pytest.approx([0.004] * 4, rel=1e-9)
    found = faces(bush_in_ring, "bush", "ring")
    between = next(face for face in found if len(face.bodies) == 2)
    assert between.radius == pytest.approx(0.01, rel=1e-9)
    assert between.area == pytest.approx(2 * pi * 0.01 * 0.012, rel=1e-9)
    outward = between.normals_from("bush")
    inside = between.points[: len(outward)]
    assert (np.einsum("ij,ij->i", outward[:, :2], inside[:, :2]) > 0.0099).all()


def test_text_of_a_face():
    text = max(faces(two_blocks, "casting", "die"), key=lambda face: face.area).text
    assert text == "die: 6 cm² around (15, 10, -10) mm, normal (0, 0, -1)"


def block_with_cavity_and_channel(occ):
    """A block round a ball that is another body, with a bore that its mirror image has too."""
    block, ball = occ.addBox(-20, -20, -20, 40, 40, 40), occ.addSphere(0, 0, 0, 6)
    rod = occ.addCylinder(-30, 14, 3, 60, 0, 0, 3)
    occ.mirror([(3, block)], 1, 0, 0, 0)
    return [rod, ball, block]


@pytest.mark.parametrize("placed", [(), ((1.0, 2.0, 0.5), 0.7)])
def test_normals_point_out_of_the_first_body(placed):
    """Seen by points on both sides, round cavities, channels and edges, in any position."""
    with gmsh_session():
        rod, ball, block = block_with_cavity_and_channel(gmsh.model.occ)
        if placed:
            axis, angle = placed
            every = [(3, tag) for tag in (rod, ball, block)]
            gmsh.model.occ.rotate(every, 0, 0, 0, *axis, angle)
        gmsh.model.occ.synchronize()
        solids = [Solid(rod, "rod", "", 4), Solid(ball, "ball", "", 2), Solid(block, "block", "")]
        volumes = join(solids, 0.0, [rod])
        found = faces_of(volumes)
        tags = {body: tag for tag, body in volumes.items()}
        assert any(face.bodies == ("block",) and face.radius is not None for face in found)
        for face in found:
            tag = tags[face.bodies[0]]
            for point, normal in zip(face.points, face.normals, strict=False):
                ahead, behind = (1e3 * point + side * 1e-3 * normal for side in (1.0, -1.0))
                assert not gmsh.model.isInside(3, tag, ahead)
                assert gmsh.model.isInside(3, tag, behind)


def test_normals_of_a_mirrored_part_point_out_of_it():
    with gmsh_session():
        (tag,) = rounded_block(gmsh.model.occ)
        gmsh.model.occ.mirror([(3, tag)], 1, 1, 0, 0)
        gmsh.model.occ.synchronize()
        found = faces_of({tag: "casting"})
    inside = np.mean([face.centre for face in found], axis=0)
    for face in found:
        assert (np.einsum("ij,j->i", face.normals, face.centre - inside) > 0).all()


def test_no_point_is_classified_to_know_the_way_out(monkeypatch):
    """It takes time in proportion to all faces for each one, minutes for parts of hundreds."""
    asked, inside = [], gmsh.model.isInside

    def counted(dim, *rest, **words):
        asked.append(dim)
        return inside(dim, *rest, **words)

    monkeypatch.setattr(gmsh.model, "isInside", counted)
    assert len(faces(rounded_block, "casting")) == 10
    assert set(asked) == {2}
