"""Cells across walls, counted in meshes whose layers are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.domain.cell_kinds import KINDS
from castx.domain.faces import face_names, neighbours
from castx.domain.gmsh_import import NamedMesh
from castx.domain.walls import Walls, walls
from tests.castx.domain.test_soundness import ALL, block

pytestmark = pytest.mark.serial

FLAT = {2: (0.04, 1.0), 3: (0.04, 1.0, 1.0)}


def plate(kind: str, layers: int = 2, along: int = 4) -> NamedMesh:
    """Return layers of cells that are long beside their height, 0.04 m high and 1 m long."""
    mesh = block(kind, along)
    kept = (mesh.points[mesh.cells][:, :, 0] <= layers / along + 1e-9).all(axis=1)
    scaled = mesh.points * np.array(FLAT[mesh.kind.dimension])
    scaled[:, 0] *= along / layers
    return replace(mesh, points=scaled, cells=mesh.cells[kept], bodies=mesh.bodies[kept])


def seen(mesh: NamedMesh, names: tuple[str, ...] = ("a",), axisymmetric: bool = False):
    across = neighbours(mesh.cells, mesh.kind.faces, "it")
    return walls(mesh, across, face_names(mesh, across, "it"), names, axisymmetric)


def named(mesh: NamedMesh, name: str, axis: int, place: float) -> NamedMesh:
    """Return the mesh with a name for its faces at a place of an axis."""
    corners = mesh.cells[:, mesh.kind.faces].reshape(-1, mesh.kind.faces.shape[1])
    on = np.isclose(mesh.points[corners][:, :, axis], place).all(axis=1)
    return replace(
        mesh, faces=corners[on], face_surfaces=np.zeros(on.sum(), dtype=np.int64),
        surface_names=(name,),
    )  # fmt: skip


@pytest.mark.parametrize("layers", [1, 2, 3])
@pytest.mark.parametrize("kind", ALL)
def test_layers_are_counted_however_they_are_cut_and_however_long_they_are(kind, layers):
    (found,) = seen(plate(kind, layers))
    thin = found.thickness < 0.5
    np.testing.assert_allclose(found.cells[thin], layers, rtol=1e-9)
    np.testing.assert_allclose(found.thickness[thin], 0.04, rtol=1e-9)
    total = 2.0 + 0.04 * (2.0 if KINDS[kind].dimension == 2 else 4.0)
    assert found.areas.sum() == pytest.approx(total, rel=1e-9)
    assert found.share(layers + 0.5) == pytest.approx(2.0 / total, rel=1e-9)
    assert found.share(layers - 0.5) == 0.0


def test_a_plane_of_symmetry_is_the_middle_of_a_wall():
    (found,) = seen(named(plate("triangle", 2), "symmetry-x", 0, 0.0))
    thin = found.thickness < 0.5
    np.testing.assert_allclose(found.cells[thin], 4.0, rtol=1e-9)
    np.testing.assert_allclose(found.thickness[thin], 0.08, rtol=1e-9)
    assert found.areas[thin].sum() == pytest.approx(1.0, rel=1e-9)  # none goes from the plane


def test_the_axis_is_the_middle_of_a_wall_and_areas_are_those_of_the_full_turn():
    (found,) = seen(plate("quadrilateral", 2), axisymmetric=True)
    thin = found.thickness < 0.5
    np.testing.assert_allclose(found.thickness[thin], 0.08, rtol=1e-9)
    assert found.areas[thin].sum() == pytest.approx(2.0 * np.pi * 0.04, rel=1e-9)


def test_a_ring_off_the_axis_is_no_thicker_than_its_wall():
    mesh = plate("triangle", 2)
    moved = replace(mesh, points=mesh.points + np.array([0.5, 0.0]))
    (found,) = seen(moved, axisymmetric=True)
    thin = found.thickness < 0.5
    np.testing.assert_allclose(found.thickness[thin], 0.04, rtol=1e-9)
    assert found.areas[thin].sum() == pytest.approx(2.0 * np.pi * (0.5 + 0.54), rel=1e-9)


def test_walls_end_where_another_body_begins():
    mesh = plate("hexahedron", 4)
    upper = (mesh.points[mesh.cells].mean(axis=1)[:, 0] > 0.03).astype(np.int64)
    lower, above = seen(replace(mesh, bodies=upper), ("a", "b"))
    np.testing.assert_allclose(lower.cells[lower.cells < 3.5], 3.0, rtol=1e-9)
    np.testing.assert_allclose(above.cells[above.cells < 1.5], 1.0, rtol=1e-9)
    assert lower.share(3.5) > 0.5 and above.share(1.5) > 0.5
    assert lower.free_of({"b"}).share(3.5) == 0.0  # the other body bears it
    assert lower.free_of({"outside"}).share(3.5) == lower.share(3.5)


def test_quantiles_go_by_area():
    found = Walls(
        np.array([1.0, 3.0, 6.0, 5.0]), np.array([2.0, 1.0, 3.0, np.inf]),
        np.array([0.2, 0.1, 0.3, np.inf]), np.zeros((4, 2), dtype=np.int64), ("a",),
    )  # fmt: skip
    assert found.quantile(found.thickness, 0.1, 3.5) == 0.1
    assert found.quantile(found.thickness, 0.35, 3.5) == 0.2
    assert found.quantile(found.cells, 0.9, 3.5) == 3.0
    assert found.share(2.5) == pytest.approx(4.0 / 15.0)
