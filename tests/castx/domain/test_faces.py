"""Neighbours of cells, and names of faces, of meshes drawn by hand."""

import numpy as np
import pytest

from castx.domain.cell_kinds import HEXAHEDRON, QUADRILATERAL, TRIANGLE
from castx.domain.faces import (
    INSIDE,
    NO_NEIGHBOUR,
    cell_faces,
    face_keys,
    face_names,
    marked_between,
    neighbours,
)
from castx.domain.gmsh_import import NamedMesh
from castx.errors import MeshError

pytestmark = pytest.mark.serial

POINTS = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]], dtype=float)
# Left and right square, corners in the order of DOLFINx: edges 0-1, 0-2, 1-3, 2-3.
CELLS = np.array([[0, 1, 3, 4], [1, 2, 4, 5]])


def two_squares(faces=(), surfaces=(), names=("bottom", "middle"), bodies=(0, 1)):
    return NamedMesh(
        QUADRILATERAL,
        POINTS,
        CELLS,
        np.array(bodies),
        np.array(faces, dtype=np.int64).reshape(-1, 2),
        np.array(surfaces, dtype=np.int64),
        names,
    )


def test_faces_with_the_same_nodes_have_the_same_key():
    first = np.array([[7, 3, 5], [1, 2, 3]])
    second = np.array([[5, 7, 3], [3, 2, 1], [1, 2, 4]])
    a, b = face_keys(first, second)
    assert a[0] == b[0] and a[1] == b[1]
    assert len({*a.tolist(), *b.tolist()}) == 3


def test_keys_do_not_mix_up_large_numbers():
    """Faces of the same sum or product of nodes are still different ones."""
    rng = np.random.default_rng(1)
    faces = rng.choice(10**6, (2000, 4))
    (keys,) = face_keys(faces)
    expected = {tuple(row) for row in np.sort(faces, axis=1).tolist()}
    assert len(np.unique(keys)) == len(expected)


def test_faces_come_cell_by_cell():
    found = cell_faces(CELLS, QUADRILATERAL.faces)
    assert found[:4].tolist() == [[0, 1], [0, 3], [1, 4], [3, 4]]
    assert found[4:].tolist() == [[1, 2], [1, 4], [2, 5], [4, 5]]


def test_neighbours_are_mutual():
    across = neighbours(CELLS, QUADRILATERAL.faces, "test")
    none = NO_NEIGHBOUR
    assert across.tolist() == [[none, none, 1, none], [none, 0, none, none]]


def test_neighbours_in_space_face_each_other():
    """Eight hexahedra in a cube: every cell has three neighbours, one across each inner face."""
    number = np.arange(27).reshape(3, 3, 3)
    cells = np.array(
        [
            [number[i + a, j + b, k + c] for c in (0, 1) for b in (0, 1) for a in (0, 1)]
            for i in (0, 1) for j in (0, 1) for k in (0, 1)
        ]
    )  # fmt: skip
    across = neighbours(cells, HEXAHEDRON.faces, "test")
    assert ((across != NO_NEIGHBOUR).sum(axis=1) == 3).all()
    for cell, face in zip(*np.nonzero(across != NO_NEIGHBOUR), strict=True):
        other = across[cell, face]
        back = np.flatnonzero(across[other] == cell)
        assert len(back) == 1
        shared = set(cells[cell][HEXAHEDRON.faces[face]])
        assert shared == set(cells[other][HEXAHEDRON.faces[back[0]]])


def test_three_cells_at_one_face_are_refused():
    triangles = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    with pytest.raises(MeshError, match=r"part\.msh: more than two elements share a face"):
        neighbours(triangles, TRIANGLE.faces, "part.msh")


def test_outer_faces_have_the_names_of_surfaces_and_inner_ones_of_the_other_body():
    mesh = two_squares(faces=[[1, 0]], surfaces=[0])
    across = neighbours(CELLS, QUADRILATERAL.faces, "test")
    names = face_names(mesh, across, "test")
    bottom, left, right = 0, 2, 3  # two surfaces, then the bodies
    assert names.tolist() == [[bottom, INSIDE, right, INSIDE], [INSIDE, left, INSIDE, INSIDE]]


def test_faces_within_a_body_have_no_name():
    mesh = two_squares(faces=[[1, 4]], surfaces=[1], bodies=(0, 0))
    across = neighbours(CELLS, QUADRILATERAL.faces, "test")
    assert (face_names(mesh, across, "test") == INSIDE).all()
    assert marked_between(mesh, across) == {}


def test_a_face_with_two_names_is_refused():
    mesh = two_squares(faces=[[0, 1], [1, 0]], surfaces=[0, 1])
    across = neighbours(CELLS, QUADRILATERAL.faces, "test")
    with pytest.raises(MeshError, match=r"test: surfaces .* overlap; a face has one name"):
        face_names(mesh, across, "test")


def test_named_faces_between_bodies_are_kept_as_points():
    mesh = two_squares(faces=[[4, 1], [0, 1]], surfaces=[1, 0])
    across = neighbours(CELLS, QUADRILATERAL.faces, "test")
    marked = marked_between(mesh, across)
    assert list(marked) == ["middle"]
    assert marked["middle"].tolist() == [[1, 0], [1, 1]]
