"""The process of a scene answers in a file, and refuses in words."""

import json
import subprocess
import sys

import pytest

from castx.input.child_process import REFUSED
from tests.castx.app.scenes.test_mesh import CASE

pytestmark = pytest.mark.serial


def answered(folder, **asked):
    request, answer = folder / "request", folder / "answer"
    request.write_text(json.dumps(asked))
    command = [sys.executable, "-P", "-m", "castx.app.scenes.child"]
    files = [str(request), str(answer), str(REFUSED)]
    ended = subprocess.run([*command, *files], capture_output=True, check=False, timeout=60)
    return ended.returncode, answer.read_text()


def test_a_mesh_is_answered_and_a_wrong_case_refused(tmp_path):
    asked = {"scene": "mesh", "text": CASE.format(size="5 mm"), "path": str(tmp_path / "case.toml")}
    code, text = answered(tmp_path, **asked)
    assert code == 0 and json.loads(text)["bodies"][0]["cells"] > 0
    code, text = answered(tmp_path, **{**asked, "text": "[time]\nend = 1\n"})
    assert code == REFUSED and "geometry" in text


def test_a_folder_without_results_is_refused(tmp_path):
    code, text = answered(tmp_path, scene="moment", path=str(tmp_path), field="gap")
    assert code == REFUSED and "run.json" in text
