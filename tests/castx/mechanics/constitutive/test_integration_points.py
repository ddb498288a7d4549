"""Integration points: weights of the models, interpolation, and integrals over the ranks."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
import ufl

from castx.domain.measures import nodal_sum, nodal_volumes
from castx.domain.mesh import BodyMesh
from castx.mechanics.constitutive.integration_points import IntegrationPoints, quadrature_degree
from tests.elastic_bodies import generated

pytestmark = pytest.mark.sampled

LENGTH, WIDTH, DEPTH = 0.02, 0.01, 0.008
MODELS = ("plane-strain", "plane-stress", "axisymmetric", "3d")
CELLS = ("simplices", "quadrilaterals")


def slab(comm, model: str, cells: str) -> BodyMesh:
    depth: dict[str, Any] = {"depth": DEPTH} if model == "3d" else {}
    mesh = generated(
        comm, model, "slab", ["casting"], length=LENGTH, width=WIDTH, size=0.004, cells=cells,
        **depth,
    )  # fmt: skip
    return mesh.bodies["casting"]


def made(comm, model: str, cells: str) -> tuple[BodyMesh, IntegrationPoints]:
    body = slab(comm, model, cells)
    return body, IntegrationPoints(body, model, 2)


def owned(body: BodyMesh, points: IntegrationPoints) -> int:
    return body.mesh.topology.index_map(body.mesh.topology.dim).size_local


@pytest.mark.parametrize("cells", CELLS)
@pytest.mark.parametrize("model", MODELS)
def test_weights_sum_to_the_volume(comm, model, cells):
    """A plane body is 1 m thick; a turned one has 2π r, here ∫ 2π r dr over the length."""
    body, points = made(comm, model, cells)
    volume = comm.allreduce(points.weights[: owned(body, points)].sum())
    expected = {"3d": LENGTH * WIDTH * DEPTH, "axisymmetric": np.pi * LENGTH**2 * WIDTH}
    assert volume == pytest.approx(expected.get(model, LENGTH * WIDTH), rel=1e-12)
    area = comm.allreduce((points.sizes[: owned(body, points)] ** body.mesh.geometry.dim).sum())
    assert area == pytest.approx(LENGTH * WIDTH * (DEPTH if model == "3d" else 1.0), rel=1e-12)
    assert points.components == (6 if model == "3d" else 4)
    assert points.count == points.cells * points.per_cell == points.weights.size


@pytest.mark.parametrize("cells", CELLS)
def test_nodal_values_reach_the_points_as_ufl_evaluates_them(comm, cells):
    body, points = made(comm, "plane-strain", cells)
    x = body.nodes.tabulate_dof_coordinates()
    values = 3.0 + 20.0 * x[:, 0] - 7.0 * x[:, 1]
    place = ufl.SpatialCoordinate(body.mesh)
    exact = points.evaluate(points.expression(3.0 + 20.0 * place[0] - 7.0 * place[1])).ravel()
    np.testing.assert_allclose(points.from_nodes(values), exact, rtol=1e-12)


@pytest.mark.parametrize("cells", CELLS)
def test_means_and_values_of_cells(comm, cells):
    """The mean of r weighted by r over each cell, by an integral of higher degree."""
    body, points = made(comm, "axisymmetric", cells)
    r = ufl.SpatialCoordinate(body.mesh)[0]
    at_points = points.evaluate(points.expression(r)).ravel()
    fine = IntegrationPoints(body, "axisymmetric", 5)
    r_fine = fine.by_cell(fine.evaluate(fine.expression(r)).ravel())
    expected = (fine.weights * r_fine).sum(axis=1) / fine.weights.sum(axis=1)
    np.testing.assert_allclose(points.cell_means(at_points), expected, rtol=1e-12)
    tensors = at_points[:, None] * np.arange(1.0, 5.0)
    np.testing.assert_allclose(points.cell_means(tensors), expected[:, None] * np.arange(1.0, 5.0))
    numbers = np.arange(float(points.cells))
    spread = points.from_cells(numbers)
    assert spread.shape == (points.count,)
    np.testing.assert_allclose(points.cell_means(spread), numbers, rtol=1e-12)
    np.testing.assert_array_equal(points.by_cell(spread), np.tile(numbers, (points.per_cell, 1)).T)


@pytest.mark.ranks
@pytest.mark.parametrize("cells", CELLS)
@pytest.mark.parametrize("model", MODELS)
def test_integrals_at_nodes_sum_to_the_integral(comm, model, cells):
    """The shape functions sum to one: Σ_i ∫ N_i v = ∫ v, here of v = x."""
    body, points = made(comm, model, cells)
    x = points.evaluate(points.expression(ufl.SpatialCoordinate(body.mesh)[0])).ravel()
    nodes = len(body.nodes.tabulate_dof_coordinates())
    total = comm.allreduce(points.to_nodes(x, nodes).sum())
    exact = {"3d": LENGTH**2 / 2 * WIDTH * DEPTH, "axisymmetric": 2 / 3 * np.pi * LENGTH**3 * WIDTH}
    assert total == pytest.approx(exact.get(model, LENGTH**2 / 2 * WIDTH), rel=1e-12)


@pytest.mark.ranks
def test_what_is_even_is_shared_by_the_volumes_of_the_nodes(comm):
    """As nodal volumes by forms: with a third of a triangle for each node, an axis gets 4/3."""
    for model, cells, degree in itertools.product(MODELS, CELLS, (1, 2)):
        body = slab(comm, model, cells)
        own = body.nodes.dofmap.index_map.size_local
        points = IntegrationPoints(body, model, degree)
        here = points.shared_to_nodes(np.ones(points.count), len(body.parent_vertices))
        found = nodal_sum(body, here)[:own]
        np.testing.assert_allclose(found, nodal_volumes(body, model), rtol=1e-12)


@pytest.mark.parametrize(
    ("model", "formulation", "cells", "degree"),
    [("plane-strain", "mixed", "simplices", 1), ("plane-stress", "mixed", "simplices", 2),
     ("plane-stress", "displacement", "simplices", 1),
     ("plane-strain", "q1p0", "quadrilaterals", 2)],
)  # fmt: skip
def test_degree_of_the_rule(comm, model, formulation, cells, degree):
    assert quadrature_degree(slab(comm, model, cells), model, formulation) == degree


@pytest.mark.ranks
@pytest.mark.parametrize("cells", CELLS)
def test_integrals_over_the_body_are_those_of_all_ranks(comm, cells):
    """Of 1 and of a linear function, on each rank alike."""
    body, points = made(comm, "plane-strain", cells)
    x = body.nodes.tabulate_dof_coordinates()
    found = points.integrals([np.ones(len(x)), 2.0 - 30.0 * x[:, 0] + 5.0 * x[:, 1]])
    area = LENGTH * WIDTH
    exact = [area, area * (2.0 - 15.0 * LENGTH + 2.5 * WIDTH)]
    np.testing.assert_allclose(found, exact, rtol=1e-12)


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric"])
def test_means_over_the_cells_around_nodes(comm, model):
    """Of x in the middle of columns of cells, by ∫ N r where r counts."""
    body, points = made(comm, model, "quadrilaterals")
    x, size = body.nodes.tabulate_dof_coordinates()[:, 0], LENGTH / 5
    found = points.means_around_nodes(x[points.cell_nodes].mean(axis=1))
    left, right = (np.clip(x + side * size / 2, size / 2, LENGTH - size / 2) for side in (-1, 1))
    share = 0.5 - (size / (6 * np.maximum(x, size)) if model == "axisymmetric" else 0.0)
    np.testing.assert_allclose(found, share * left + (1 - share) * right, rtol=1e-12)
