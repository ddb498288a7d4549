"""Mesh files are data: nothing in them or beside them is executed."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.source import named_mesh, write_mesh, write_moved
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


@pytest.mark.parametrize("end", [".vtu", ".inp", ".med"])
def test_other_formats_hold_cells_bodies_and_surfaces(tmp_path, end) -> None:
    generated = Geometry.model_validate(
        {
            "generator": "two_slabs", "model": "3d", "length": 0.02, "mould_length": 0.01,
            "width": 0.01, "depth": 0.01, "size": 0.01, "cells": "quadrilaterals",
        }
    )  # fmt: skip
    file = tmp_path / f"slabs{end}"
    write_mesh(generated, file, ["casting", "mould"])
    mesh = meshio.read(file)
    hexahedra = mesh.get_cells_type("hexahedron")
    corners = mesh.points[hexahedra]
    assert np.ptp(corners, axis=1) == pytest.approx(np.full((3, 3), 0.01))
    # Each corner of a hexahedron of VTK differs from the next one round its base along one edge.
    around = corners[:, [1, 2, 3, 0]] - corners[:, :4]
    assert np.count_nonzero(np.abs(around) > 1e-9, axis=2).tolist() == [[1] * 4] * 3
    faces = mesh.get_cells_type("quad")
    assert len(faces) == 2 + 3 * 4  # two ends, and four sides of three cells
    if end == ".inp":
        assert {"casting", "mould", "far", "top"} <= set(mesh.cell_sets)
    else:
        bodies = mesh.get_cell_data("body", "hexahedron")
        assert sorted(bodies.ravel().tolist()) == [0, 0, 1]
        surfaces = mesh.get_cell_data("surface", "quad")
        assert len(set(surfaces.ravel().tolist())) == 5 and surfaces.min() == 0


def test_unknown_formats_and_folders_are_refused(tmp_path) -> None:
    file = tmp_path / "part.msh"
    file.write_text(SQUARE)
    with pytest.raises(MeshError, match=r"cannot write .*part\.doc: formats: "):
        write_mesh(geometry(file), tmp_path / "part.doc", ["casting"])
    with pytest.raises(MeshError, match=r"meshio cannot write .*part\.vtu: "):
        write_mesh(geometry(file), tmp_path / "nowhere" / "part.vtu", ["casting"])


def test_a_moved_mesh_keeps_cells_and_names(tmp_path) -> None:
    file, target = tmp_path / "part.msh", tmp_path / "moved.msh"
    file.write_text(SQUARE)
    seen = []

    def move(nodes, cells):
        seen.extend(cells)
        return 2.0 * nodes

    write_moved(file, target, move)
    assert [corners.tolist() for corners in seen] == [[[0, 1, 2], [0, 2, 3]]]
    before, after = (named_mesh(geometry(path), ["casting"]) for path in (file, target))
    np.testing.assert_array_equal(after.points, 2.0 * before.points)
    np.testing.assert_array_equal(after.cells, before.cells)
    assert after.surface_names == before.surface_names == ("side",)
    with pytest.raises(MeshError, match=r"written as \.msh"):
        write_moved(file, tmp_path / "moved.vtu", move)
