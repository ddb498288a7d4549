"""Kinds of cells: shape functions, quadrature, corners and faces in the order of DOLFINx."""

from math import factorial

from mpi4py import MPI

import numpy as np
import pytest
from dolfinx import mesh

from castx.domain.cell_kinds import HEXAHEDRON, KINDS, kinds_of_dimension

pytestmark = pytest.mark.serial

GMSH_CORNERS = {
    "interval": [[0], [1]],
    "triangle": [[0, 0], [1, 0], [0, 1]],
    "quadrilateral": [[0, 0], [1, 0], [1, 1], [0, 1]],
    "tetrahedron": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "hexahedron": [
        [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1],
    ],
}  # fmt: skip
"""Corners of the reference cells in the order of gmsh, from its manual."""
every_kind = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)


@every_kind
def test_corners_of_gmsh_come_into_the_order_of_dolfinx(kind):
    from_gmsh = np.array(GMSH_CORNERS[kind.name], dtype=float)[list(kind.from_gmsh)]
    np.testing.assert_allclose(from_gmsh, kind.reference)
    assert kind.corners == len(kind.reference)
    assert kind.simplex == (kind.corners == kind.dimension + 1)


@every_kind
def test_shape_functions_are_one_at_their_corner_and_reproduce_positions(kind):
    values, slopes = kind.shape_functions(kind.reference)
    np.testing.assert_allclose(values, np.eye(kind.corners), atol=1e-14)
    points = np.random.default_rng(3).random((7, kind.dimension)) / kind.dimension
    values, slopes = kind.shape_functions(points)
    np.testing.assert_allclose(values @ kind.reference, points, atol=1e-14)
    step = 1e-6
    for axis in range(kind.dimension):
        shift = step * np.eye(kind.dimension)[axis]
        ends = [kind.shape_functions(points + sign * shift)[0] for sign in (1, -1)]
        np.testing.assert_allclose(slopes[:, :, axis], (ends[0] - ends[1]) / (2 * step), atol=1e-9)


@every_kind
@pytest.mark.parametrize("degree", [1, 2, 3, 4])
def test_quadrature_is_exact_for_its_degree(kind, degree):
    """∫ x^degree: degree!/(degree + d)! on simplices, 1/(degree + 1) on boxes."""
    points, weights = kind.quadrature(degree)
    exact = factorial(degree) / factorial(degree + kind.dimension)
    if not kind.simplex:
        exact = 1 / (degree + 1)
    assert weights @ points[:, 0] ** degree == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("name", ["triangle", "quadrilateral", "tetrahedron", "hexahedron"])
def test_jacobians_of_an_affine_image_are_its_matrix(name):
    kind = KINDS[name]
    A = np.random.default_rng(4).random((kind.dimension, kind.dimension)) + np.eye(kind.dimension)
    corners = (kind.reference @ A.T + 3.0)[None]
    jacobians = kind.jacobians(corners, kind.reference)
    np.testing.assert_allclose(jacobians[0], np.broadcast_to(A, jacobians[0].shape), atol=1e-13)
    volumes = kind.corner_volumes(corners)
    assert volumes.shape == (1, 1 if kind.simplex else kind.corners)
    np.testing.assert_allclose(volumes, np.linalg.det(A), rtol=1e-12)
    image = corners[:, kind.mirrored] * np.array([-1.0, 1.0, 1.0])[: kind.dimension]
    np.testing.assert_allclose(kind.corner_volumes(image), np.linalg.det(A), rtol=1e-12)


def test_a_facet_in_space_has_a_jacobian_with_two_columns():
    kind = KINDS["quadrilateral"]
    corners = np.array([[[0, 0, 5], [2, 0, 5], [0, 3, 5], [2, 3, 5.0]]])
    expected = [[[[2, 0], [0, 3], [0, 0]]]]
    found = kind.jacobians(corners, np.array([[0.5, 0.5]]))
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_a_folded_cell_has_a_negative_corner_volume():
    corners = HEXAHEDRON.reference.copy()
    corners[0] = 1.5
    volumes = HEXAHEDRON.corner_volumes(corners[None])[0]
    assert volumes.min() < 0 < volumes.max()


MESHES = {
    "triangle": lambda: mesh.create_unit_square(MPI.COMM_SELF, 1, 1),
    "quadrilateral": lambda: mesh.create_unit_square(
        MPI.COMM_SELF, 1, 1, mesh.CellType.quadrilateral
    ),
    "tetrahedron": lambda: mesh.create_unit_cube(MPI.COMM_SELF, 1, 1, 1),
    "hexahedron": lambda: mesh.create_unit_cube(MPI.COMM_SELF, 1, 1, 1, mesh.CellType.hexahedron),
}


@pytest.mark.parametrize("name", MESHES)
def test_faces_are_the_facets_of_dolfinx_in_their_order(name):
    domain, kind = MESHES[name](), KINDS[name]
    topology = domain.topology
    dim = topology.dim
    topology.create_connectivity(dim, dim - 1)
    topology.create_connectivity(dim - 1, 0)
    for cell in range(topology.index_map(dim).size_local):
        corners = topology.connectivity(dim, 0).links(cell)
        for face, facet in zip(
            kind.faces, topology.connectivity(dim, dim - 1).links(cell), strict=True
        ):
            nodes = topology.connectivity(dim - 1, 0).links(facet)
            assert set(corners[face]) == set(nodes)
    assert kind.faces.shape[1] == KINDS[kind.face].corners


def test_kinds_by_dimension():
    names = [[kind.name for kind in kinds_of_dimension(dimension)] for dimension in (1, 2, 3)]
    expected = [["interval"], ["triangle", "quadrilateral"], ["tetrahedron", "hexahedron"]]
    assert names == expected
