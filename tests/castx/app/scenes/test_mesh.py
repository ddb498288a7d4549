"""The scene of a mesh has the facets of its bodies, and their number of cells."""

from pathlib import Path

import pytest

from castx.app.scenes.mesh import mesh_scene
from castx.errors import CaseError
from castx.report.packing import unpacked
from tests.castx.app.scenes.test_triangles import area

pytestmark = pytest.mark.serial

CASE = """
[geometry]
generator = "two_slabs"
model = "3d"
length = 0.02
mould_length = 0.01
width = 0.01
depth = 0.01
size = "{size}"
[[bodies]]
name = "casting"
material = "Al-pure"
temperature = 700
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 20
[time]
end = 1
[vary]
"""


def drawn(size="5 mm", model="3d"):
    text = CASE.format(size=size).replace('"3d"', f'"{model}"')
    text = text if model == "3d" else text.replace("depth = 0.01\n", "")
    return mesh_scene(text, Path("case.toml"))


def test_all_faces_of_the_bodies_are_drawn():
    found = drawn()
    points, counts = unpacked(found["points"]).reshape(-1, 3, 3), unpacked(found["counts"])
    assert counts.sum() == len(points)
    # two boxes of 20 x 10 x 10 mm and 10 x 10 x 10 mm
    assert area(points).sum() == pytest.approx(1e-6 * (1000 + 600), rel=1e-5)
    names = [face["text"] for face in found["faces"]]
    assert "casting/far" in names and "casting/mould" in names and not found["flat"]
    assert [body["name"] for body in found["bodies"]] == ["casting", "mould"]


def test_finer_sizes_make_more_cells():
    coarse, fine = (drawn(size)["bodies"][0]["cells"] for size in ("5 mm", "2.5 mm"))
    assert fine == pytest.approx(8 * coarse, rel=0.3)


def test_plane_bodies_are_drawn_by_their_cells():
    found = drawn(model="plane-strain")
    assert found["flat"] and [face["text"] for face in found["faces"]] == ["casting", "mould"]
    counts = unpacked(found["counts"]).tolist()
    assert counts == [body["cells"] for body in found["bodies"]]


def test_what_cannot_be_accepted_is_refused():
    with pytest.raises(CaseError, match="positive"):
        drawn("-1 mm")
