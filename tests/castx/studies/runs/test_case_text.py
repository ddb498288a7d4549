"""A case with other values."""

import pytest

from castx.studies.runs.case_text import changed_content
from tests.castx.many_runs import CASE

pytestmark = pytest.mark.serial


def test_values_are_changed_and_studies_left_out(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE + "[vary]\ndraws = 3\n")
    changes = {"bodies.0.temperature": 690.0, "output.folder": "there"}
    found = changed_content(path, ["time.end=3"], changes)
    assert found["bodies"][0]["temperature"] == 690.0 and found["time"]["end"] == 3
    assert "vary" not in found and "folder" not in found["output"]
