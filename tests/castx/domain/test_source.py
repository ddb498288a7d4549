"""Mesh files are data: nothing in them or beside them is executed."""

from __future__ import annotations

from pathlib import Path

import pytest

from castx.case.geometry import Geometry
from castx.domain.source import named_mesh
from castx.errors import MeshError

pytestmark = pytest.mark.serial

SQUARE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "side"
2 2 "casting"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
3
1 1 2 1 1 1 2
2 2 2 2 1 1 2 3
3 2 2 2 1 1 3 4
$EndElements
"""


def geometry(file: Path) -> Geometry:
    return Geometry.model_validate({"model": "plane-strain", "file": file})


def test_a_mesh_is_read(tmp_path) -> None:
    file = tmp_path / "part.msh"
    file.write_text(SQUARE)
    mesh = named_mesh(geometry(file), ["casting"])
    assert mesh.cells.shape == (2, 3)


def test_a_script_is_not_run(tmp_path) -> None:
    file, trace = tmp_path / "part.msh", tmp_path / "trace"
    file.write_text(f'SystemCall "touch {trace}";\n')
    with pytest.raises(MeshError, match=r"part\.msh is not a gmsh mesh: .*\$MeshFormat"):
        named_mesh(geometry(file), ["casting"])
    assert not trace.exists()


def test_options_beside_a_mesh_are_not_run(tmp_path) -> None:
    file, trace = tmp_path / "part.msh", tmp_path / "trace"
    file.write_text(SQUARE)
    (tmp_path / "part.msh.opt").write_text(f'SystemCall "touch {trace}";\n')
    named_mesh(geometry(file), ["casting"])
    assert not trace.exists()


def test_a_missing_file_is_named(tmp_path) -> None:
    with pytest.raises(MeshError, match=r"there is no mesh file .*gone\.msh"):
        named_mesh(geometry(tmp_path / "gone.msh"), ["casting"])
