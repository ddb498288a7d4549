"""How long a run will take, by those of the folder that came to their end."""

import json

import pytest

from castx.app.runs.expected import PastRun, cells_of, expectation, nearest, past_run

pytestmark = pytest.mark.serial

CASE = """
name = "bar"
[geometry]
generator = "stacked_blocks"
model = "plane-strain"
upper = [0.02, 0.02]
base = [0.02, 0.01]
size = 0.005
[[bodies]]
name = "base"
material = "steel-carbon"
temperature = 20
[[bodies]]
name = "upper"
material = "steel-carbon"
temperature = 20
[[interfaces]]
bodies = ["upper", "base"]
heat = { law = "constant", closed = 1000 }
[coupling]
scheme = "thermal"
[time]
end = 10
"""


def write_past(folder, name="bar", scheme="thermal", cells=1000, wall=100.0, reason="finished"):
    folder.mkdir(parents=True)
    record = {
        "castx": "0.2.0", "model": "3d", "case": {"name": name}, "scheme": scheme, "end": 10.0,
        "bodies": {"base": {"cells": cells // 4}, "upper": {"cells": cells - cells // 4}},
        "totals": {"steps": 80}, "wall": wall, "exit": {"reason": reason},
    }  # fmt: skip
    (folder / "run.json").write_text(json.dumps(record))
    return folder.name, folder


def said(tmp_path, cells, *folders, text=CASE):
    return expectation(text, tmp_path / "bar.toml", cells, folders)


def test_the_time_of_a_run_is_scaled_by_the_cells(tmp_path):
    found = said(tmp_path, 3000, write_past(tmp_path / "results/bar"))
    assert found["seconds"] == pytest.approx(300.0)
    assert found["text"] == (
        "about 0:05:00 for 3000 cells: bar took 0:01:40 for 1000, in 80 steps to 10 s"
    )
    far = said(tmp_path, 30_000, write_past(tmp_path / "results/other", name="lug"))
    assert far["seconds"] == pytest.approx(3000.0)
    assert "about 0:50:00" in far["text"] and "other, of another case, took" in far["text"]
    assert far["text"].endswith("by so many other cells, a guess")


@pytest.mark.parametrize(
    "changed, why",
    [
        ({"reason": ""}, "no run of this folder has come to its end yet"),
        ({"reason": "interrupted"}, "no run of this folder has come to its end yet"),
        ({"scheme": "iterated"}, "no run of this folder with the scheme thermal has come"),
        ({"wall": 0.0}, "no run of this folder has come to its end yet"),
    ],
)
def test_nothing_is_known_without_such_a_run(tmp_path, changed, why):
    found = said(tmp_path, 500, write_past(tmp_path / "results/bar", **changed))
    assert found["seconds"] is None and found["text"].startswith(f"unknown: {why}")


def test_nothing_is_known_without_a_mesh_but_of_a_run_with_the_same_geometry(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    unknown = {"seconds": None, "text": "unknown: make the mesh first, in the tab Mesh, which "
                                        "tells its cells"}  # fmt: skip
    assert said(tmp_path, 0) == unknown
    name, folder = write_past(tmp_path / "results/bar", reason="interrupted", cells=2000)
    older = write_past(tmp_path / "results/bar.1", wall=50.0)
    geometry = {
        "generator": "stacked_blocks", "model": "plane-strain", "upper": [0.02, 0.02],
        "base": [0.02, 0.01], "size": 0.005,
    }  # fmt: skip
    (folder / "case.json").write_text(json.dumps({"geometry": geometry}))
    assert cells_of(folder, geometry) == 2000
    assert said(tmp_path, 0, (name, folder), older)["seconds"] == pytest.approx(100.0)
    finer = CASE.replace("size = 0.005", "size = 0.004")
    assert said(tmp_path, 0, (name, folder), older, text=finer) == unknown
    assert said(tmp_path, 500, older, text="not toml") == {"seconds": None, "text": ""}


def test_the_same_case_tells_more_than_as_many_cells():
    def run(results, case, cells, scheme="iterated"):
        return PastRun(results, case, scheme, cells, 100, 10.0, 60.0)

    runs = [run("a", "lug", 900), run("b", "bar", 100), run("c", "bar", 400), run("d", "bar", 1000)]
    assert nearest(runs, "bar", "iterated", 1000).results == "d"
    assert nearest(runs, "bar", "iterated", 200).results in ("b", "c")
    assert nearest(runs, "wheel", "iterated", 800).results == "a"
    assert nearest(runs, "bar", "thermal", 1000) is None


def test_a_folder_that_cannot_be_read_tells_nothing(tmp_path):
    assert past_run(tmp_path, "x") is None
    (tmp_path / "run.json").write_text("[]")
    assert past_run(tmp_path, "x") is None and cells_of(tmp_path, {}) == 0
