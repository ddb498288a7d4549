"""Answers of a run are those of its report, read once."""

import json
import os

import pytest

from castx.report.summary.finding import Finding
from castx.report.summary.freezing import STILL_LIQUID
from castx.studies.runs import answers as module
from castx.studies.runs.answers import ANSWERS, answers

pytestmark = pytest.mark.serial


def test_they_are_the_findings_and_read_once(monkeypatch, tmp_path):
    gap = Finding("Largest gap", "a/b", 3e-5, "µm", "", factor=1e6, of_mesh=True)
    liquid = Finding(STILL_LIQUID, "a", 0.5, "%", "", factor=100.0)
    asked = []
    monkeypatch.setattr(module, "Results", asked.append)
    monkeypatch.setattr(module, "findings", lambda run: [liquid, gap])
    for _ in range(2):
        (found,) = answers(tmp_path / "results").values()
        assert (found.name, found.value, found.unit) == ("Largest gap: a/b", 3e-5, "µm")
        assert found.shown == pytest.approx(30.0) and found.of_mesh
    assert asked == [tmp_path / "results"]
    for damage in ("[[1, 2]]", "", "{}", '[["a", "b", "c", 1]]'):
        (tmp_path / ANSWERS).write_text(damage)
        assert list(answers(tmp_path / "results")) == ["Largest gap: a/b"]
    (tmp_path / ANSWERS).unlink()
    os.mkfifo(tmp_path / ANSWERS)
    assert list(answers(tmp_path / "results")) == ["Largest gap: a/b"]
    assert len(asked) == 6
    assert json.loads((tmp_path / ANSWERS).read_text()) == [
        ["Largest gap: a/b", 3e-5, "µm", 1e6, True]
    ]
