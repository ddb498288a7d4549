"""Touching solids share faces, mismatches within the tolerance are closed, overlaps refused."""

from __future__ import annotations

import gmsh
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.assembly import join, refuse_other_bodies
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.reading import Solid
from tests.cad_files import two_blocks

pytestmark = pytest.mark.serial


def joined(shift=(0.0, 0.0, 0.0), tolerance=0.0, names=("casting", "die")):
    """Volumes [mm³] by body, and the area [m²] of the faces between two of them."""
    with gmsh_session():
        tags = two_blocks(gmsh.model.occ, shift)
        gmsh.model.occ.synchronize()
        solids = [Solid(tag, name, name) for tag, name in zip(tags, names, strict=True)]
        volumes = join(solids, tolerance)
        areas = [face.area for face in faces_of(volumes) if len(face.bodies) == 2]
        sizes = [(body, gmsh.model.occ.getMass(3, tag)) for tag, body in volumes.items()]
        return sizes, areas


def test_touching_solids_share_a_face():
    sizes, areas = joined()
    assert dict(sizes) == pytest.approx({"casting": 4000.0, "die": 6000.0}, rel=1e-12)
    assert areas == pytest.approx([4e-4], rel=1e-12)


def test_solids_of_one_body_have_no_face_between_them():
    sizes, areas = joined(names=("casting", "casting"))
    assert sum(volume for _, volume in sizes) == pytest.approx(1e4, rel=1e-12)
    assert not areas


def test_of_what_is_drilled_nothing_is_left():
    with gmsh_session():
        block = gmsh.model.occ.addBox(0, 0, 0, 20, 20, 10)
        drill = gmsh.model.occ.addCylinder(10, 10, -5, 0, 0, 20, 2)
        gmsh.model.occ.synchronize()
        volumes = join([Solid(block, "die", ""), Solid(drill, "hole", "", 1)], 0.0, [drill])
        assert list(volumes.values()) == ["die"]
        assert gmsh.model.getEntities(3) == [(3, tag) for tag in volumes]


@pytest.mark.parametrize("shift", [(0, 0, 0.01), (0, 0, -0.01), (0.01, 0.003, -0.01)])
def test_a_mismatch_within_the_tolerance_is_closed(shift):
    sizes, areas = joined(shift, 2e-5)
    assert [body for body, _ in sizes] == ["casting", "die"]
    assert areas == pytest.approx([4e-4], rel=1e-3)


def test_a_gap_beyond_the_tolerance_stays():
    assert joined((0, 0, 0.01), 1e-6)[1] == []


def test_an_overlap_beyond_the_tolerance_is_refused_with_place_and_size():
    text = (
        r"'casting' and 'die' overlap by 0.4 cm³ round \(0.01, 0.01, -0.0005\) m; cut one of "
        "them in CAD, or raise geometry.tolerance, 1e-06 m"
    )
    with pytest.raises(ValueError, match=text):
        joined((0, 0, -1.0), 1e-6)


def test_solids_that_are_not_the_bodies_of_the_case_are_listed():
    with gmsh_session():
        tags = two_blocks(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        solids = [Solid(tags[0], "top", "top"), Solid(tags[1], "solid-2", "")]
        volumes = {solid.tag: solid.name for solid in solids}
        refuse_other_bodies(None, volumes, solids)
        refuse_other_bodies(("solid-2", "top"), volumes, solids)
        with pytest.raises(ValueError, match=r"no solid is the body 'mould'(.|\n)*solid-2: sol"):
            refuse_other_bodies(("top", "mould"), volumes, solids)
        with pytest.raises(ValueError, match="does not list the body 'solid-2' under"):
            refuse_other_bodies(("top",), volumes, solids)


def test_a_skin_left_over_from_a_cut_is_refused_with_its_place():
    """A box of 20 mm out of which one smaller by 0.3 µm on each side is cut."""
    with gmsh_session():
        occ = gmsh.model.occ
        thin = 3e-4
        inner = occ.addBox(thin, thin, thin, *(3 * (20 - 2 * thin,)))
        ((_, skin),), _ = occ.cut([(3, occ.addBox(0, 0, 0, 20, 20, 20))], [(3, inner)])
        block = occ.addBox(30, 0, 0, 20, 20, 20)
        occ.synchronize()
        solids = [Solid(skin, "skin", ""), Solid(block, "block", "")]
        text = r"'skin' round \(0.01, 0.01, 0.01\) m is 3e-07 m thick .*; remove or repair it"
        with pytest.raises(ValueError, match=text):
            join(solids, 1e-6)
        assert list(join(solids, 1e-8).values()) == ["skin", "block"]
