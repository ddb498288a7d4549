"""Selectors pick the faces they describe, together and one by one."""

from __future__ import annotations

from math import radians

import gmsh
import pytest

from castx.domain.source import gmsh_session
from castx.meshes.cad.assembly import join
from castx.meshes.cad.description import Selector
from castx.meshes.cad.faces import faces_of
from castx.meshes.cad.reading import Solid
from castx.meshes.cad.selection import named_faces, other_body, select, shown
from tests.cad_files import bush_in_ring, two_blocks

pytestmark = pytest.mark.serial

UP = (0.0, 0.0, 1.0)


def faces_between(solids, *names):
    with gmsh_session():
        tags = solids(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        made = [Solid(tag, name, name) for tag, name in zip(tags, names, strict=True)]
        return faces_of(join(made, 0.0))


@pytest.fixture(scope="module")
def blocks():
    return faces_between(two_blocks, "casting", "die")


@pytest.mark.parametrize(
    "selector, area",
    [
        ({"normal": UP}, 4e-4 + 2e-4),
        ({"normal": UP, "body": "casting"}, 4e-4),
        ({"normal": (0.0, 0.0, -1.0), "body": "casting", "touches": "die"}, 4e-4),
        ({"touches": "die"}, 4e-4),
        ({"touches": "casting"}, 4e-4),
        ({"largest": 1}, 6e-4),
        ({"largest": 2}, 6e-4 + 4e-4),
        ({"largest": 1, "body": "casting", "normal": (1.0, 0.0, 0.0)}, 2e-4),
        ({"within": ((-1.0, -1.0, 0.01), (1.0, 1.0, 0.01))}, 4e-4),
        ({"within": ((-1.0, -1.0, -0.001), (1.0, 1.0, 1.0)), "body": "casting"}, 12e-4),
        ({"normal": (0.8, 0.0, 0.6), "angle": 40.0}, 2e-4 + 2e-4),
        ({"normal": (0.8, 0.0, 0.6), "angle": 60.0}, 2e-4 + 2e-4 + 4e-4 + 2e-4),
        ({"body": "die"}, 18e-4),
    ],
)
def test_areas_of_what_is_selected(blocks, selector, area):
    selector = {**selector, "angle": radians(selector.get("angle", 1.0))}
    assert sum(face.area for face in select(Selector("s", **selector), blocks)) == pytest.approx(
        area, rel=1e-12
    )


def test_a_radius_selects_bores():
    faces = faces_between(bush_in_ring, "bush", "ring")
    outer = select(Selector("s", radius=0.02), faces)
    assert [face.bodies for face in outer] == [("ring",)]
    bore = select(Selector("s", radius=0.01, touches="ring"), faces)
    assert [set(face.bodies) for face in bore] == [{"bush", "ring"}]
    with pytest.raises(ValueError, match=r"'s' selects no face; there are:\n  ring: .*radius 20"):
        select(Selector("s", radius=0.011), faces)


def test_a_shared_face_has_another_body_and_another_normal_for_each(blocks):
    (shared,) = (face for face in blocks if len(face.bodies) == 2)
    assert other_body(shared, "die") == "casting" and other_body(shared, "casting") == "die"
    for body, up in (("casting", -1.0), ("die", 1.0)):
        assert shared.normals_from(body)[:, 2] == pytest.approx(up)


def test_the_rest_is_one_surface(blocks):
    named = named_faces([Selector("top", normal=UP)], blocks, ["casting", "die"], "outside")
    assert {name: len(faces) for name, faces in named.items()} == {"top": 2, "outside": 9}


@pytest.mark.parametrize(
    "selectors, text",
    [
        ([Selector("a", body="cast")], "surface 'a': no body 'cast'; there are: casting, die"),
        ([Selector("a", touches="cast")], "surface 'a': no body 'cast'"),
        ([Selector("a", normal=(0.6, 0.8, 0.0))], "'a' selects no face; there are:\n  die: 6 cm²"),
        (
            [Selector("a", normal=UP), Selector("b", body="casting")],
            r"'a' and 'b' both select a face, and it has one name: casting: 4 cm² around",
        ),
    ],
)
def test_refusals_say_what_there_is(blocks, selectors, text):
    with pytest.raises(ValueError, match=text):
        named_faces(selectors, blocks, ["casting", "die"], "outside")


def test_a_long_list_of_faces_is_cut(blocks):
    assert shown(blocks * 5).endswith("and 30 smaller ones")


def test_a_body_without_such_faces_says_which_it_has():
    faces = faces_between(bush_in_ring, "bush", "ring")
    closed = [face for face in faces if face.bodies != ("bush",)]
    text = "'top' selects no face: bush has no free face; touches = \"BODY\" .* shares with ring$"
    with pytest.raises(ValueError, match=text):
        select(Selector("top", body="bush", normal=UP), closed)
    free = [face for face in faces if len(face.bodies) == 1]
    with pytest.raises(ValueError, match=r"no face: ring shares faces with no body$"):
        select(Selector("top", touches="ring"), free)
