"""The process that meshes CAD files answers with a report or a reason, and its exit code."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys

import pytest

from castx.meshes.cad.description import CadFile, CadPart
from tests.cad_files import two_blocks, write_cad

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "name, code, most, said",
    [
        ("two.step", 0, 2e6, ""),
        ("lost.step", 7, 2e6, "cannot read the CAD file"),
        ("two.step", 4, 2.0, "geometry.most_cells allows 2.0e+00"),
    ],
)
def test_answer_and_exit_code(tmp_path, name, code, most, said):
    write_cad(tmp_path / "two.step", two_blocks)
    part = CadPart((CadFile(str(tmp_path / name)),), 0.02, most_cells=most)
    request, mesh, answer = (tmp_path / end for end in ("request", "mesh.msh", "answer"))
    request.write_bytes(pickle.dumps(part))
    command = [sys.executable, "-P", "-m", "castx.domain.cad.child"]
    given = [str(request), str(mesh), str(answer), "7"]
    ended = subprocess.run([*command, *given], capture_output=True, check=False, cwd="/")
    assert ended.returncode == code, ended.stderr
    if code:
        assert said in answer.read_text()
    else:
        assert [body["name"] for body in json.loads(answer.read_text())["bodies"]] == [
            "solid-1",
            "solid-2",
        ]
        assert mesh.read_bytes().startswith(b"$MeshFormat")
