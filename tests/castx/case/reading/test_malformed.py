"""Malformed case files and meshes are refused soon, with file, key and cure, and no traceback."""


import pytest
from hypothesis import HealthCheck, given, settings

from tests.castx.mutations import (
    Answer,
    answer,
    case_tables,
    case_texts,
    mesh_case,
    mesh_text,
    meshes,
)

pytestmark = pytest.mark.serial
FEW = settings(
    max_examples=25, suppress_health_check=list(HealthCheck), derandomize=True, database=None
)


def refusals(answers: list[Answer]) -> int:
    return sum(found.code == 2 for found in answers)


@pytest.mark.parametrize("kind", ["tables", "texts"])
def test_spoilt_case_files(kind, tmp_path, capsys):
    answers: list[Answer] = []
    file = tmp_path / "spoilt.toml"

    @FEW
    @given(case_tables() if kind == "tables" else case_texts())
    def check(content):
        file.write_bytes(content.encode() if isinstance(content, str) else content)
        found = answer(file, capsys)
        answers.append(found)
        assert not found.faults(file), (found.text, content)

    check()
    assert refusals(answers) > 15


@pytest.mark.parametrize("version", [4.1, 2.2])
def test_spoilt_meshes(version, tmp_path, capsys):
    whole = mesh_text(tmp_path / "whole.msh", version)
    part, file = tmp_path / "part.msh", tmp_path / "case.toml"
    file.write_text(mesh_case("part.msh"))
    answers: list[Answer] = []
    part.write_bytes(whole)
    assert answer(file, capsys).code == 0

    @FEW
    @given(meshes(whole))
    def check(content):
        part.write_bytes(content)
        found = answer(file, capsys)
        answers.append(found)
        assert not found.faults(file), (found.text, content)

    check()
    assert refusals(answers) > 10


