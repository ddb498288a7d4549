"""A record of a run is refused with the place of what does not fit."""

import json

import pytest

from castx.errors import CaseError
from castx.results.files.run_json import LARGEST, completed, number_of_cells, read_record

pytestmark = pytest.mark.serial

GOOD = {
    "castx": "0.1",
    "case": {"name": "a", "file": "/a.toml", "digest": "0"},
    "model": "axisymmetric",
    "scheme": "iterated",
    "end": 5.0,
    "bodies": {"casting": {"nodes": 7, "freezes": [577.0, 615]}, "mould": {}},
    "interfaces": {"casting/mould": {"pairs": 5, "heat": None}},
    "time_reached": 1,
    "totals": {"steps": 3},
    "process": [{"time": 0.0, "cycle": 1, "stage": 0, "bodies": ["casting"]}],
    "exit": {"reason": "finished", "message": ""},
    "more": [1, 2],
}


def test_a_record_is_returned_as_it_stands(tmp_path):
    (tmp_path / "run.json").write_text(json.dumps(GOOD))
    assert read_record(tmp_path / "run.json") == GOOD


def test_what_is_left_out_has_its_usual_value():
    found = completed(GOOD)
    for key in ("case", "model", "time_reached", "exit", "more"):
        assert found[key] == GOOD[key], key
    assert (found["totals"]["steps"], found["totals"]["passes"]) == (3, 0)
    assert found["bodies"]["casting"]["freezes"] == [577.0, 615]
    assert found["bodies"]["casting"]["symmetry"] == found["stage_ends"] == []
    assert found["versions"] == {}


def test_cells_are_those_of_all_bodies_that_tell_them():
    record = {"bodies": {"casting": {"cells": 7}, "mould": {"cells": 5}, "core": {}}}
    assert number_of_cells(record) == 12


@pytest.mark.parametrize(
    ("key", "value", "place"),
    [
        ("time_reached", "long", "time_reached: Input should be a valid number"),
        ("bodies", ["casting"], "bodies: Input should be a valid dictionary"),
        ("bodies", {"casting": {"nodes": "7"}}, "bodies.casting.nodes"),
        ("interfaces", {"casting/mould": None}, 'interfaces."casting/mould"'),
        ("case", 5, "case: "),
        ("exit", {"reason": 0}, "exit.reason"),
        ("process", [{"ejection": {"casting": 3}}], r"process\[0\].ejection.casting"),
        ("model", "flat", "model: Input should be 'plane-stress'"),
        ("bodies", {"casting": {"freezes": [577.0]}}, "bodies.casting.freezes"),
        ("versions", ["1.0"], "versions: Input should be a valid dictionary"),
        ("castx", 5, "castx: Input should be a valid string"),
        ("end", float("nan"), "end: Input should be a finite number"),
        ("time_reached", -5.0, "time_reached: Input should be greater than or equal to 0"),
        (
            "bodies",
            {"casting": {"symmetry": [{"plane": 3}]}},
            r"symmetry\[0\].normal: Field required",
        ),
        (
            "bodies",
            {"guss": {}, "mould": {}},
            "interfaces.'casting/mould': 'casting' is no body of it",
        ),
        ("stage_ends", [{"bodies": {"wheel": {}}}], r"stage_ends\[0\].bodies: 'wheel' is no body"),
        ("hot_spots", [{"x": 1}], r"hot_spots\[0\].body: '' is no body of it \(casting, mould\)"),
        ("feeding", {"wheel": {}}, "feeding: 'wheel' is no body of it"),
    ],
)
def test_wrong_types_are_refused_with_their_place(tmp_path, key, value, place):
    (tmp_path / "run.json").write_text(json.dumps({**GOOD, key: value}))
    with pytest.raises(CaseError, match=place):
        read_record(tmp_path / "run.json")


@pytest.mark.parametrize("content", [b"\xff\xfe", b"[1]", b"{", b"[" * 10**5])
def test_what_is_no_record_is_refused(tmp_path, content):
    (tmp_path / "run.json").write_bytes(content)
    with pytest.raises(CaseError, match=r"run.json (is no record of a run|cannot be read)"):
        read_record(tmp_path / "run.json")


def test_a_record_of_absurd_size_is_not_read(tmp_path):
    with (tmp_path / "run.json").open("wb") as file:
        file.truncate(LARGEST + 1)
    with pytest.raises(CaseError, match="larger than 64 MiB"):
        read_record(tmp_path / "run.json")
