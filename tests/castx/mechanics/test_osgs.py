"""The operator Gᵀ M⁻¹ G of OSGS against dense element matrices, and what it must leave alone."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem, la

from castx.arrays import FloatArray
from castx.domain.measures import cell_measure
from castx.domain.mesh import BodyMesh
from castx.forms import stabilisation
from castx.mechanics.fixed_directions import FixedDirections
from castx.mechanics.formulation import BodyUnknowns
from castx.mechanics.osgs import OrthogonalProjection, _tangential
from tests.castx.mechanics.lone_bodies import slab

SHEAR = 26e9


def projected(body: BodyMesh, model: str, planes=()):
    """Return unknowns, a τ that jumps by orders of magnitude, and the assembled operator."""
    unknowns = BodyUnknowns(body, model, True, SHEAR)
    tau = fem.Function(fem.functionspace(body.mesh, ("DG", 0)))
    centres = body.points[body.nodes.dofmap.list].mean(axis=1)
    tau.x.array[:] = 1e-15 * 10.0 ** np.round(3 * np.abs(np.sin(900 * centres.sum(axis=1))))
    operator = OrthogonalProjection(unknowns, tau, planes)
    operator.assemble()
    return unknowns, tau, operator


def product(unknowns: BodyUnknowns, operator: OrthogonalProjection, pressure) -> FloatArray:
    """Return what the operator adds to the rows of the owned pressures for a pressure [Pa]."""
    x = np.zeros(unknowns.owned).reshape(-1, unknowns.block_size)
    x[:, unknowns.dimension] = pressure[: len(x)] / unknowns.pressure_scale
    y = np.full(x.shape, 3.0)
    operator.add_product(x.ravel(), y.ravel())
    assert (np.delete(y, unknowns.dimension, axis=1) == 3.0).all(), "forces stay as they are"
    return y[:, unknowns.dimension] - 3.0


def dense(body: BodyMesh, tau: FloatArray, projectors: FloatArray) -> FloatArray:
    """Return Gᵀ P M⁻¹ G of a plane body by the gradients of the corners of its triangles."""
    count = len(body.points)
    G, M = np.zeros((count, 2, count)), np.zeros(count)
    for cell, corners in enumerate(body.nodes.dofmap.list):
        edges = body.points[corners][1:, :2] - body.points[corners][0, :2]
        area = abs(np.linalg.det(edges)) / 2
        gradients = np.linalg.inv(edges) @ np.array([[-1.0, 1, 0], [-1, 0, 1]])
        M[corners] += tau[cell] * area / 3
        for corner in corners:
            G[corner][:, corners] += tau[cell] * area / 3 * gradients
    projection = np.einsum("nij,njp->nip", projectors, G / M[:, None, None])
    return np.einsum("nip,niq->pq", G, projection)


@pytest.mark.serial  # the dense matrix is that of one rank
def test_operator_is_that_of_dense_element_matrices(comm):
    body = slab(comm)
    unknowns, tau, operator = projected(body, "plane-strain")
    whole = dense(body, tau.x.array, np.tile(np.eye(2), (len(body.points), 1, 1)))
    pressure = np.sin(1.0 + np.arange(len(body.points)))
    expected = unknowns.pressure_scale * whole @ pressure
    found = product(unknowns, operator, pressure)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * np.abs(expected).max())


@pytest.mark.serial
def test_symmetry_planes_have_no_normal_component(comm):
    body = slab(comm)
    nodes = body.surface_nodes("bottom")
    plane = FixedDirections("bottom", nodes, np.tile([0.0, 1.0], (len(nodes), 1)), symmetry=True)
    unknowns, tau, operator = projected(body, "plane-strain", [plane])
    projectors = np.tile(np.eye(2), (len(body.points), 1, 1))
    projectors[nodes, 1, 1] = 0.0
    pressure = np.sin(1.0 + np.arange(len(body.points)))
    expected = unknowns.pressure_scale * dense(body, tau.x.array, projectors) @ pressure
    found = product(unknowns, operator, pressure)
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12 * np.abs(expected).max())


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_what_gls_takes_from_a_linear_pressure_comes_back(comm, model):
    """Π = ∇p wherever p is linear, however τ jumps: nothing is left of the stabilisation."""
    body = slab(comm, model)
    unknowns, tau, operator = projected(body, model)
    p, q = fem.Function(body.nodes), ufl.TestFunction(body.nodes)
    p.x.array[:] = 1e6 + body.points @ np.array([3e8, -2e8, 1e8])[: body.points.shape[1]]
    gls = fem.assemble_vector(
        fem.form(stabilisation.pressure_laplacian(p, q, tau, cell_measure(body, model, 2)))
    )
    gls.scatter_reverse(la.InsertMode.add)
    expected = unknowns.pressure_scale * gls.array[: body.nodes.dofmap.index_map.size_local]
    found = product(unknowns, operator, p.x.array)
    scale = comm.allreduce(np.abs(expected).max(initial=0.0), op=max)
    np.testing.assert_allclose(found, expected, atol=1e-10 * scale, rtol=0)
    assert scale > 0


@pytest.mark.ranks
def test_without_weight_nothing_is_projected(comm):
    """Inside trapped liquid τ is zero at all cells of a node."""
    body = slab(comm)
    unknowns = BodyUnknowns(body, "plane-strain", True, SHEAR)
    tau = fem.Function(fem.functionspace(body.mesh, ("DG", 0)))
    operator = OrthogonalProjection(unknowns, tau, ())
    operator.assemble()
    assert not product(unknowns, operator, np.sin(np.arange(len(body.points)))).any()


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_a_pressure_that_bends_between_parts_is_left_alone_by_one_projection_for_each(comm, model):
    """The plane x = 5 mm stands for the front: one part may lie on one rank alone."""
    body = slab(comm, model)
    unknowns, dx = BodyUnknowns(body, model, True, SHEAR), cell_measure(body, model, 2)
    cells = fem.functionspace(body.mesh, ("DG", 0))
    left, ones = fem.Function(cells), fem.Function(cells)
    at = np.median(np.unique(np.round(comm.allreduce(list(body.points[:, 0]), op=MPI.SUM), 9)))
    left.x.array[:] = body.points[body.nodes.dofmap.list, 0].mean(axis=1) < at
    ones.x.array[:] = 1.0
    p, q = fem.Function(body.nodes), ufl.TestFunction(body.nodes)
    p.x.array[:] = 3e8 * np.minimum(body.points[:, 0] - at, 0.0)
    tau = 1e-15 + 1e-11 * (1 - left)
    gls = fem.assemble_vector(fem.form(stabilisation.pressure_laplacian(p, q, tau, dx)))
    gls.scatter_reverse(la.InsertMode.add)
    expected = unknowns.pressure_scale * gls.array[: body.nodes.dofmap.index_map.size_local]
    scale = comm.allreduce(np.abs(expected).max(initial=0.0), op=MPI.MAX)
    remaining = []
    for parts in ((ones,), (left, 1 - left)):
        found = np.zeros_like(expected)
        for part in parts:
            operator = OrthogonalProjection(unknowns, part * tau, ())
            operator.assemble()
            found += product(unknowns, operator, p.x.array)
        rest = np.abs(found - expected).max(initial=0.0)
        remaining.append(comm.allreduce(float(rest), op=MPI.MAX) / scale)
    assert remaining[0] > 0.1
    assert remaining[1] < 1e-10


@pytest.mark.ranks
def test_a_part_of_one_cell_on_one_rank_acts_on_all(comm):
    body = slab(comm)
    unknowns = BodyUnknowns(body, "plane-strain", True, SHEAR)
    tau = fem.Function(fem.functionspace(body.mesh, ("DG", 0)))
    place = body.points[body.nodes.dofmap.list].mean(axis=1) @ np.array([1.0, 0.7])
    tau.x.array[:] = 1e-15 * (place == comm.allreduce(float(place.max()), op=MPI.MAX))
    operator = OrthogonalProjection(unknowns, tau, ())
    operator.assemble()
    gradient = np.array([3e8, -2e8])
    pressure = body.points[:, :2] @ gradient
    found = product(unknowns, operator, pressure)
    work = comm.allreduce(float(found @ pressure[: len(found)]), op=MPI.SUM)
    dx = cell_measure(body, "plane-strain", 2)
    whole = comm.allreduce(fem.assemble_scalar(fem.form(tau * dx)), op=MPI.SUM)
    assert work == pytest.approx(unknowns.pressure_scale * whole * gradient @ gradient, rel=1e-9)


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_the_matrix_is_that_of_the_operator(comm, model):
    """With a symmetry plane too; of one pattern before there is any weight and after it."""
    body = slab(comm, model)
    nodes = body.surface_nodes("bottom")
    nodes = nodes[nodes < body.nodes.dofmap.index_map.size_local]
    normals = np.tile(np.eye(body.points.shape[1])[1], (len(nodes), 1))
    plane = FixedDirections("bottom", nodes, normals, symmetry=True)
    unknowns, tau, operator = projected(body, model, [plane])
    tau.x.array[:] *= 0.0
    operator.assemble()
    empty = operator.matrix()
    assert empty.norm() == 0.0
    tau.x.array[:] = 1e-15 * (1.0 + np.arange(len(tau.x.array)) % 3)
    operator.assemble()
    matrix = operator.matrix()
    for found, before in zip(matrix.getValuesCSR()[:2], empty.getValuesCSR()[:2], strict=True):
        np.testing.assert_array_equal(found, before)
    x, y = matrix.createVecs()
    x.array[:] = np.sin(1.0 + np.arange(len(x.array_r)))
    matrix.mult(x, y)
    expected = np.zeros(unknowns.owned)
    operator.add_product(x.array_r.copy(), expected)
    scale = comm.allreduce(np.abs(expected).max(initial=0.0), op=MPI.MAX)
    assert scale > 0
    np.testing.assert_allclose(y.array_r, expected, atol=1e-12 * scale, rtol=0)
    for item in (empty, matrix, x, y):
        item.destroy()


@pytest.mark.serial
def test_planes_at_any_angle_leave_the_direction_that_both_allow():
    """Planes of 22° between them leave nothing in the plane, and their common line in space."""
    c, s = np.cos(np.pi / 8), np.sin(np.pi / 8)
    for dimension, allowed in ((2, np.zeros((2, 2))), (3, np.diag([0.0, 0.0, 1.0]))):
        normals = np.zeros((2, 1, dimension))
        normals[:, 0, :2] = [[1.0, 0.0], [c, s]]
        planes: Any = [SimpleNamespace(nodes=np.array([1]), directions=n) for n in normals]
        nodes, projectors = _tangential(planes, 3, dimension)
        np.testing.assert_array_equal(nodes, [1])
        np.testing.assert_allclose(projectors[0], allowed, atol=1e-12)
