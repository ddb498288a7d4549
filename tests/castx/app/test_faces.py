"""The faces of a case for the page, read once, and never outside the folder."""

import os

import numpy as np
import pytest

from castx.app import faces
from castx.app.faces import PartViews, bodies_of, extents_of, known_surfaces
from castx.app.workplace import Workplace
from castx.errors import CaseError
from castx.meshes.cad.seen import SeenPart
from tests.castx.app.test_selectors import FACES, flat

pytestmark = pytest.mark.serial

CASE = """
[geometry]
model = "3d"
file = "part.step"
size = "5 mm"
surfaces = { up = { normal = "+z" }, none = { radius = 1 } }
"""


@pytest.fixture
def views(tmp_path, monkeypatch):
    """Views of a folder whose parts all have the same faces, and the parts that were read."""
    (tmp_path / "work").mkdir()
    for name in ("secret.step", "work/part.step"):
        (tmp_path / name).write_text("")
    read = []

    def seen(part, folder, patience):
        read.append(part)
        return SeenPart(tuple(FACES), tuple(f.points.reshape(1, 3, 3) for f in FLAT), {})

    monkeypatch.setattr(faces, "seen_apart", seen)
    return PartViews(Workplace(tmp_path / "work")), read


FLAT = [FACES[0]] * len(FACES)


def test_a_part_is_read_again_only_when_it_has_changed(views):
    found, read = views
    view = found.view("case.toml", CASE)
    assert view["bodies"] == ["part"] and view["surfaces"] == {"up": [0, 1, 2]}
    assert view["rest"] == [3, 4, 5] and "selects no face" in view["wrong"]["none"]
    found.surfaces("case.toml", CASE.replace("+z", "-z").replace("5 mm", "7 mm"))
    assert len(read) == 1
    found.of("case.toml", CASE.replace("size", 'mould = { box = "9 mm" }\nsize', 1))
    assert len(read) == 2
    os.utime(read[0].files[0].path, ns=(1, 1))
    found.of("case.toml", CASE)
    assert len(read) == 3
    assert found.view("part.step", "")["rest"] == list(range(6))


def test_names_without_faces_and_faces_with_two_names_are_told(views):
    found, _ = views
    text = CASE.replace(", none = { radius = 1 }", "") + '[[boundaries]]\non = "part/gone"\n'
    told = found.surfaces("case.toml", text)["wrong"]
    assert told == {
        "part/gone": "boundaries[0].on: no face has this name; part has part/up, part/outside"
    }
    text = CASE.replace("none = { radius = 1 }", 'more = { body = "part", normal = "+z" }')
    assert "has the name 'up'" in found.surfaces("case.toml", text)["wrong"]["more"]


def test_a_drawing_has_another_name_when_faces_may_have_changed(views):
    found, read = views

    def drawing(text):
        return found.surfaces("case.toml", text)["drawing"]

    first = drawing(CASE)
    assert drawing(CASE.replace("+z", "-z").replace("5 mm", "7 mm")) == first
    assert drawing(CASE.replace("size", 'mould = { box = "9 mm" }\nsize', 1)) != first
    os.utime(read[0].files[0].path, ns=(1, 1))
    assert drawing(CASE) != first


def test_faces_between_bodies_are_surfaces_of_both():
    shared = flat(1, [0, 0, 1], [0, 0, 0.2], [0.3, 0.1, 0.2], bodies=("part", "mould"))
    found = known_surfaces([FACES[0], shared], {"up": [0]})
    assert found == {"part/up": [0], "part/mould": [1], "mould/part": [1]}


@pytest.mark.parametrize(
    "given, order",
    [
        (["part", "core", "mould"], ["part", "core", "mould"]),
        (["mould"], ["mould", "core", "part"]),
        ([], ["core", "mould", "part"]),
        (None, ["core", "mould", "part"]),
    ],
)
def test_bodies_stand_in_the_order_of_the_case(given, order):
    """Which is that of their colours, as in the mesh."""
    corners = [0, 0, 1], [0, 0, 0.2], [0.3, 0.1, 0.2]
    found = [flat(n, *corners, bodies=b) for n, b in enumerate([("core", "mould"), ("part",)])]
    content = {} if given is None else {"bodies": [{"name": name} for name in given]}
    assert bodies_of(found, content) == order
    assert bodies_of(found, {"bodies": [7, {"name": []}]}) == bodies_of(found, {"bodies": 7})


def test_bodies_have_their_extents():
    up, down = flat(1, [0, 0, 1], [0, 0, 0.2], [0.3, 0.1, 0.2]), FACES[3]
    corners = np.array([[[0, 0, 0], [0.3, 0, 0], [0.3, 0.1, 0]]])
    found = extents_of(SeenPart((up, down), (corners, corners + np.array([0, 0, 0.2])), {}))
    assert found == {"part": pytest.approx([0.3, 0.1, 0.2])}


@pytest.mark.parametrize("file", ["../secret.step", "/etc/x.step", "missing.step"])
def test_parts_elsewhere_are_not_read(views, file):
    found, read = views
    with pytest.raises(CaseError):
        found.of("case.toml", CASE.replace("part.step", file))
    with pytest.raises(CaseError):
        found.of(file, "")
    assert not read


def test_a_case_without_cad_says_so(views):
    with pytest.raises(CaseError, match="no CAD file"):
        views[0].of("case.toml", "[time]\nend = 1\n")
