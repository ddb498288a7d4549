"""Meshes that can hardly be meant: folded, far away, doubled nodes, holes of the size of a cell."""

from __future__ import annotations

import logging
import re
from dataclasses import replace

import numpy as np
import pytest

from castx.domain.cell_kinds import KINDS
from castx.domain.faces import neighbours
from castx.domain.gmsh_import import NamedMesh
from castx.domain.soundness import (
    area_vectors,
    doubts,
    refuse_absurd_extent,
    refuse_far_away,
    refuse_folded,
)
from castx.errors import MeshError

pytestmark = pytest.mark.serial

ALL = ["triangle", "quadrilateral", "tetrahedron", "hexahedron"]


def block(kind: str, count: int = 5) -> NamedMesh:
    """Return a unit square or cube of cells in rows, of one body "a"."""
    described = KINDS[kind]
    dimension = described.dimension
    ticks = np.arange(count + 1)
    grid = np.stack(np.meshgrid(*[ticks] * dimension, indexing="ij"), axis=-1).reshape(
        -1, dimension
    )
    strides = (count + 1) ** np.arange(dimension)[::-1]
    steps = np.stack(np.meshgrid(*[(0, 1)] * dimension, indexing="ij"), axis=-1)
    boxes = grid[(grid < count).all(axis=1)] @ strides
    corners = np.moveaxis(steps, range(dimension), range(dimension)).reshape(-1, dimension)[:, ::-1]
    cells = boxes[:, None] + corners @ strides
    if kind == "triangle":
        cells = np.concatenate([cells[:, [0, 1, 3]], cells[:, [0, 3, 2]]])
    if kind == "tetrahedron":  # the six of Kuhn, all with the long diagonal
        paths = [(1, 3), (1, 5), (2, 3), (2, 6), (4, 5), (4, 6)]
        cells = np.concatenate([cells[:, [0, *path, 7]] for path in paths])
    none = np.empty((0, len(described.faces[0])), dtype=np.int64)
    bodies = np.zeros(len(cells), dtype=np.int64)
    return NamedMesh(described, grid / count, cells, bodies, none, bodies[:0], ())


def across(mesh: NamedMesh) -> np.ndarray:
    return neighbours(mesh.cells, mesh.kind.faces, "it")


def found(mesh: NamedMesh) -> list[str]:
    return list(doubts(mesh, ("a", "b"), across(mesh)))


@pytest.mark.parametrize("kind", ALL)
def test_a_good_mesh_is_accepted_wherever_its_corners_are(kind):
    mesh = block(kind)
    rng = np.random.default_rng(2)
    inner = ((mesh.points > 0.01) & (mesh.points < 0.99)).all(axis=1)
    mesh.points[inner] += rng.uniform(-0.02, 0.02, (inner.sum(), mesh.points.shape[1]))
    refuse_folded(mesh, across(mesh), "it")
    refuse_far_away(mesh, "it")
    assert found(mesh) == []
    mirrored = mesh.cells[:, mesh.kind.mirrored]
    every_other = np.arange(len(mesh.cells))[:, None] % 2 == 1
    turned = replace(mesh, cells=np.where(every_other, mirrored, mesh.cells))
    refuse_folded(turned, across(turned), "it")


@pytest.mark.parametrize(
    ("kind", "shift"),
    [*((kind, 1.3) for kind in ALL), ("triangle", 0.35), ("tetrahedron", 0.35)],
)
def test_a_node_out_of_place_is_refused_with_its_place(kind, shift):
    """Out of the part, or past its neighbour; there boxes are not convex, which is refused."""
    mesh = block(kind)
    node = int(np.argmin(np.linalg.norm(mesh.points - 0.4, axis=1)))
    mesh.points[node, 0] += shift
    with pytest.raises(MeshError, match=r"neighbouring elements lie over each other, .*at \("):
        refuse_folded(mesh, across(mesh), "it")


def test_area_vectors_are_normals():
    line = np.array([[[0.0, 0.0], [2.0, 0.0]]])
    np.testing.assert_allclose(area_vectors(line), [[0.0, -2.0]])
    corners = np.array([[0.0, 0, 0], [2.0, 0, 0], [0.0, 3.0, 0], [2.0, 3.0, 0]])
    np.testing.assert_allclose(area_vectors(corners[None, :3]), [[0.0, 0.0, 3.0]])
    np.testing.assert_allclose(np.abs(area_vectors(corners[None])), [[0.0, 0.0, 6.0]])


def test_a_mesh_far_from_the_origin_is_refused():
    mesh = block("triangle")
    refuse_far_away(replace(mesh, points=mesh.points + 9e5), "it")
    with pytest.raises(
        MeshError, match=r"it lies 1e\+09 m from the origin, 1e\+09 times its extent"
    ):
        refuse_far_away(replace(mesh, points=mesh.points + 1e9), "it")


@pytest.mark.parametrize("scale", [1e-10, 2e6, 1e150])
def test_a_mesh_of_absurd_size_is_refused(scale):
    mesh = block("triangle")
    for good in (1e-8, 1.0, 9e5):
        refuse_absurd_extent(replace(mesh, points=mesh.points * good), "it")
    with pytest.raises(MeshError, match=re.escape(f"it has an extent of {scale:.3g} m;")):
        refuse_absurd_extent(replace(mesh, points=mesh.points * scale), "it")


def test_a_mesh_in_millimetres_is_told():
    mesh = block("triangle")
    assert found(replace(mesh, points=mesh.points * 99.0)) == []
    (text,) = found(replace(mesh, points=mesh.points * 200.0))
    assert text.startswith("the mesh has an extent of 200 m") and "divide" in text


@pytest.mark.parametrize("kind", ALL)
def test_a_cell_given_to_another_body_is_told_with_its_place(kind):
    """Two halves of a block, and one cell in the midst of the left one that belongs to the right.

    A part of more than 2 % of its body may be meant, and a cell at the interface is no part.
    """
    count = 8 if kind == "tetrahedron" else 12
    mesh = block(kind, count)
    middles = mesh.points[mesh.cells].mean(axis=1)
    halves = (middles[:, 0] > 0.5).astype(np.int64)
    assert found(replace(mesh, bodies=halves)) == []
    stray = nearest(mesh, 0.3)
    mistaken = halves.copy()
    mistaken[stray] = 1
    (text,) = found(replace(mesh, bodies=mistaken))
    assert text.startswith("b has 1 elements that lie apart from its others")
    said = [float(x) for x in text.split("(")[1].split(")")[0].split(",")]
    np.testing.assert_allclose(said, middles[stray], atol=1e-5)
    core, box = halves.copy(), np.floor(middles * count)
    core[((box >= 1) & (box <= count / 2 - 2)).all(axis=1)] = 1
    assert found(replace(mesh, bodies=core)) == []


def without(mesh: NamedMesh, cells: list[int]) -> NamedMesh:
    kept = np.setdiff1d(np.arange(len(mesh.cells)), cells)
    return replace(mesh, cells=mesh.cells[kept], bodies=mesh.bodies[kept])


def nearest(mesh: NamedMesh, place: float) -> int:
    middles = mesh.points[mesh.cells].mean(axis=1)
    return int(np.argmin(np.linalg.norm(middles - place, axis=1)))


@pytest.mark.parametrize("kind", ALL)
@pytest.mark.parametrize("count", [3, 5])  # cells in a row: one is more than 2 % of 3 x 3
def test_a_cell_that_touches_no_other_is_told_with_its_place(kind, count):
    mesh = block(kind, count)
    lost = mesh.cells[nearest(mesh, 0.3)]
    away = mesh.points[lost] + 5.0
    cells = np.vstack([mesh.cells, len(mesh.points) + np.arange(len(lost))])
    bodies = np.append(mesh.bodies, 0)
    points = np.concatenate([mesh.points, away])
    (text,) = found(replace(mesh, cells=cells, bodies=bodies, points=points))
    assert text.startswith("a has 1 elements that lie apart from its others and touch no body, ")
    said = [float(x) for x in text.split("(")[1].split(")")[0].split(",")]
    np.testing.assert_allclose(said, away.mean(axis=0), atol=1e-5)
    halves = np.repeat(np.arange(2), [len(mesh.cells), 1])
    assert found(replace(mesh, cells=cells, bodies=halves, points=points)) == []


@pytest.mark.parametrize(("count", "told"), [(7, False), (8, True)])
def test_one_of_few_cells_may_be_meant(count, told):
    mesh = block("quadrilateral", 3)
    apart = [*range(count - 1), 8] if count < 8 else range(8)
    lone = replace(mesh, cells=mesh.cells.copy())
    lone.cells[8] = len(mesh.points) + np.arange(4)
    points = np.concatenate([mesh.points, mesh.points[mesh.cells[8]] + 5.0])
    kept = sorted({*apart, 8})[-count:]
    few = replace(lone, cells=lone.cells[kept], bodies=mesh.bodies[kept], points=points)
    assert any("touch no body" in text for text in found(few)) == told


@pytest.mark.parametrize("kind", ALL)
def test_a_missing_cell_is_told_with_its_place(kind):
    mesh = block(kind)
    gone = nearest(mesh, 0.5)
    middle = mesh.points[mesh.cells[gone]].mean(axis=0)
    (text,) = found(without(mesh, [gone]))
    assert text.startswith("1 holes inside are no larger than 4 elements, the first at (")
    place = [float(x) for x in text.split("(")[1].split(")")[0].split(",")]
    np.testing.assert_allclose(place, middle, atol=1e-5)
    corner = nearest(mesh, 0.0)
    assert found(without(mesh, [corner])) == []  # a pit from outside may be meant


@pytest.mark.parametrize("kind", ALL)
def test_a_large_hole_and_one_with_a_name_are_meant(kind):
    mesh = block(kind, 7)
    middles = mesh.points[mesh.cells].mean(axis=1)
    inside = np.flatnonzero((np.abs(middles - 0.5) < 2.5 / 7).all(axis=1))
    assert found(without(mesh, list(inside))) == []
    gone = nearest(mesh, 0.5)
    holed = without(mesh, [gone])
    faces = mesh.cells[gone][mesh.kind.faces]
    names = replace(holed, faces=faces, face_surfaces=np.zeros(len(faces), dtype=np.int64),
                    surface_names=("bubble",))  # fmt: skip
    assert found(names) == []


@pytest.mark.parametrize("kind", ALL)
def test_doubled_nodes_of_a_body_are_told(kind):
    """A cut at half height: the cells above have nodes of their own."""
    mesh = block(kind, 4)
    middles = mesh.points[mesh.cells].mean(axis=1)
    upper = middles[:, 1] > 0.5
    on_cut = np.flatnonzero(np.isclose(mesh.points[:, 1], 0.5))
    twins = np.arange(len(mesh.points))
    twins[on_cut] = len(mesh.points) + np.arange(len(on_cut))
    cells = np.where(upper[:, None], twins[mesh.cells], mesh.cells)
    cut = replace(mesh, cells=cells, points=np.concatenate([mesh.points, mesh.points[on_cut]]))
    (text,) = found(cut)
    assert f"a has {len(on_cut)} pairs of nodes at the same place" in text
    two = replace(cut, bodies=upper.astype(np.int64))  # two bodies that only touch
    assert found(two) == []


def test_nodes_a_billionth_of_the_mesh_apart_are_doubled():
    mesh = block("triangle", 2)
    upper = mesh.points[mesh.cells].mean(axis=1)[:, 1] > 0.5
    on_cut = np.flatnonzero(np.isclose(mesh.points[:, 1], 0.5))
    twins = np.arange(len(mesh.points))
    twins[on_cut] = len(mesh.points) + np.arange(len(on_cut))
    cells = np.where(upper[:, None], twins[mesh.cells], mesh.cells)
    for apart, count in ((5e-10, 1), (2e-9, 0)):
        points = np.concatenate([mesh.points, mesh.points[on_cut] + [0.0, apart]])
        assert len(found(replace(mesh, cells=cells, points=points))) == count


def test_what_is_doubtful_is_said_and_what_is_folded_refused(comm, tmp_path, caplog):
    """On the way from a file to the bodies."""
    from castx.case.geometry import Geometry
    from castx.domain.mesh import build_mesh

    mesh = block("triangle")
    logging.getLogger("castx").propagate = True

    def read(mesh: NamedMesh):
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "1", '2 1 "a"']
        lines += ["$EndPhysicalNames", "$Nodes", str(len(mesh.points))]
        x, y = mesh.points.T
        lines += [f"{k + 1} {x[k]:.17g} {y[k]:.17g} 0" for k in range(len(x))]
        lines += ["$EndNodes", "$Elements", str(len(mesh.cells))]
        corners = [" ".join(map(str, cell + 1)) for cell in mesh.cells]
        lines += [f"{k + 1} 2 2 1 1 {text}" for k, text in enumerate(corners)]
        (tmp_path / "a.msh").write_text("\n".join([*lines, "$EndElements", ""]))
        file = {"file": str(tmp_path / "a.msh"), "model": "plane-strain"}
        return build_mesh(Geometry.model_validate(file), ["a"], comm)

    read(without(mesh, [nearest(mesh, 0.5)]))
    assert "a.msh: 1 holes inside" in caplog.text
    mesh.points[8, 0] += 1.3
    with pytest.raises(MeshError, match="lie over each other"):
        read(mesh)
    with pytest.raises(MeshError, match="from the origin"):
        read(replace(block("triangle"), points=block("triangle").points + 1e9))
