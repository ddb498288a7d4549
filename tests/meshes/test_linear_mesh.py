"""Kinds of cells in the numbering of gmsh: orientation, mirror images, free faces."""

import numpy as np
import pytest

from castx.meshes.linear_mesh import (
    KINDS,
    LinearMesh,
    checked_cells,
    compacted,
    free_faces,
    handedness,
    mirrored,
    oriented,
)

pytestmark = pytest.mark.serial

CORNERS = {
    (2, 3): [[0, 0], [1, 0], [0, 1]],
    (2, 4): [[0, 0], [1, 0], [1, 1], [0, 1]],
    (3, 4): [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    (3, 8): [
        [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
    ],
}  # fmt: skip
"""Corners of a proper cell of each kind, as gmsh numbers them."""
every_kind = pytest.mark.parametrize("kind", KINDS, ids=str)


def one_cell(kind, stretch=(2.0, 3.0, 5.0), shift=1.0):
    """Return a mesh of one cell, off the planes in which it is mirrored."""
    points = np.array(CORNERS[kind], dtype=float) * stretch[: kind[0]] + shift
    cells = np.arange(len(points))[None]
    return LinearMesh(points, cells, np.array([7]), np.arange(len(points)))


@every_kind
def test_handedness_is_the_product_of_the_edges(kind):
    mesh = one_cell(kind)
    assert handedness(mesh.points, mesh.cells) == pytest.approx([6.0 if kind[0] == 2 else 30.0])


@every_kind
def test_a_mirror_image_becomes_a_proper_cell(kind):
    mesh = one_cell(kind)
    image = mesh.points * np.array([-1.0, 1.0, 1.0])[: kind[0]]
    assert handedness(image, mesh.cells) < 0
    turned = oriented(image, mesh.cells)
    assert handedness(image, turned) > 0
    assert sorted(turned[0]) == sorted(mesh.cells[0])
    # The edges are the same ones: no cell is folded by the new order of its corners.
    faces = {frozenset(mesh.cells[0, list(face)]) for face in mesh.kind.faces}
    assert {frozenset(turned[0, list(face)]) for face in mesh.kind.faces} == faces
    assert np.array_equal(oriented(mesh.points, mesh.cells), mesh.cells)


@every_kind
def test_the_faces_of_one_cell_enclose_it(kind):
    """Each corner lies on as many faces as the cell has edges there, and all faces are free."""
    mesh = one_cell(kind)
    faces = free_faces(mesh)
    assert len(faces) == len(mesh.kind.faces)
    assert np.array_equal(np.bincount(faces.ravel()), np.full(len(mesh.points), kind[0]))


@every_kind
def test_mirrored_cells_share_the_nodes_of_the_plane(kind):
    mesh = one_cell(kind, shift=0.0)
    whole = mirrored(mesh, 0)
    on_plane = np.count_nonzero(mesh.points[:, 0] == 0.0)
    assert len(whole.points) == 2 * len(mesh.points) - on_plane
    assert (handedness(whole.points, whole.cells) > 0).all()
    assert np.array_equal(whole.regions, [7, 7])
    shared = {tuple(face) for face in np.sort(free_faces(mesh), axis=1)} - {
        tuple(face) for face in np.sort(free_faces(whole), axis=1)
    }
    assert len(shared) == (1 if on_plane >= kind[0] else 0)


def test_compacting_leaves_out_unused_points_and_keeps_the_positions():
    mesh = one_cell((2, 3))
    points = np.concatenate([[[9.0, 9.0]], mesh.points, [[8.0, 8.0]]])
    loose = LinearMesh(points, mesh.cells + 1, mesh.regions, np.array([5, 0, 1, 2, 6]))
    tight = compacted(loose)
    assert np.array_equal(tight.points[tight.cells], mesh.points[mesh.cells])
    assert np.array_equal(tight.order, [0, 1, 2]) and len(tight.points) == 3


def test_other_cells_are_refused():
    with pytest.raises(ValueError, match="must be simplices or quadrilaterals, got 'hexahedra'"):
        checked_cells("hexahedra")
