"""Problems of a case file with their lines."""

import pytest

from castx.app.checking import checked
from tests.castx.command_line import CASE

pytestmark = pytest.mark.serial


def lines(text, tmp_path):
    return [(p["line"], p["key"]) for p in checked(text, tmp_path / "case.toml")["problems"]]


def test_a_good_case_is_described(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = checked(CASE, tmp_path / "case.toml")
    assert found["problems"] == []
    assert found["case"] == {
        "name": "case", "model": "axisymmetric", "cad": False, "bodies": ["casting", "mould"],
        "end": 0.2, "results": "results/case",
    }  # fmt: skip


def test_problems_have_key_line_and_cure(tmp_path):
    text = CASE.replace('"Al-pure"', '"Al-pur"').replace("time]\nend = 0.2", "time]\nend = -1")
    wrong = checked(text + "\n[vary]\nnumbers = 3\n", tmp_path / "case.toml")
    rows = text.splitlines()
    found = {p["key"]: p for p in wrong["problems"]}
    assert wrong["case"] is None
    assert found["time.end"]["line"] == rows.index("end = -1") + 1
    assert any(key.startswith("vary") for key in found)
    (material,) = checked(CASE.replace('"Al-pure"', '"Al-pur"'), tmp_path / "c.toml")["problems"]
    assert material["key"] == "bodies[0].material"
    assert material["line"] == rows.index('material = "Al-pur"') + 1
    assert 'did you mean "Al-pure"' in material["text"]


def test_what_is_no_toml_has_its_line(tmp_path):
    assert lines("a = 1\nb = = 2\n", tmp_path) == [(2, "")]
    assert lines("a = 1\nb = [1,\n", tmp_path) == [(2, "")]
    assert lines("a" * 10 + "=1\n" + "=" * 30_000, tmp_path) == [(None, "")]
