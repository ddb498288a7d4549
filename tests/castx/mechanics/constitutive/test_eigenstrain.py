"""Strain without stress of cells in which some metal contracts and some does not."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.mechanics.constitutive.eigenstrain import AXES, eigenstrain, front_normals
from castx.mechanics.constitutive.growth import Growth
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.places import MetalPlaces
from tests.castx.mechanics.lone_bodies import slab

KINDS = [("plane-strain", "simplices"), ("plane-strain", "quadrilaterals"), ("3d", "simplices")]
every_kind = pytest.mark.parametrize("model, cells", KINDS, ids="-".join)
CONTRACTION = -3e-3
DIRECTION = np.array([0.6, 0.8, 0.0])


def made(comm, model: str, cells: str):
    """Return the points of a slab, and the places of its nodes, (nodes, gdim)."""
    body = slab(comm, model, cells)
    points = IntegrationPoints(body, model, 2 if cells == "quadrilaterals" else 1)
    return points, body.points


def behind_a_front(x: np.ndarray, direction: np.ndarray) -> Growth:
    """Return metal that has frozen where x·n is small, contracting all alike there."""
    depth = x @ direction[: x.shape[1]]
    share = (depth < 0.012).astype(float)
    return Growth(share, CONTRACTION * share, CONTRACTION * share)


def tensors(components: np.ndarray) -> np.ndarray:
    """Return components as tensors, shape (points, 3, 3)."""
    full = np.zeros((len(components), 3, 3))
    for values, (i, j) in zip(components.T, AXES, strict=False):
        full[:, i, j] = full[:, j, i] = values
    return full


@every_kind
@pytest.mark.ranks
def test_the_normal_is_that_of_the_isotherms(comm, model, cells):
    points, x = made(comm, model, cells)
    dimension = x.shape[1] if model == "3d" else 2
    x = x[:, :dimension]
    found = front_normals(points, 500.0 + 2e3 * x @ DIRECTION[:dimension])
    expected = np.tile(DIRECTION[:dimension], (points.count, 1))
    np.testing.assert_allclose(found, expected, atol=1e-12)
    assert not front_normals(points, np.full(len(x), 600.0)).any()


@pytest.mark.ranks
def test_a_node_that_is_early_hardly_leans_the_normals_round_it(comm):
    """By a fifth of a cell, the isotherms in the cells at that node lean by 0.2."""
    points, x = made(comm, "plane-strain", "simplices")
    early = np.isclose(x[:, 0], 0.01) & np.isclose(x[:, 1], 0.005)
    found = front_normals(points, 500.0 + 2e3 * x[:, 0] + 2.0 * early)
    gradient = points.gradients(500.0 + 2e3 * x[:, 0] + 2.0 * early)
    leaning = np.abs(gradient[:, 1] / gradient[:, 0]).max(initial=0.0)
    assert comm.allreduce(leaning, op=MPI.MAX) > 0.15
    assert np.abs(found[:, 1]).max(initial=0.0) < 0.03


def test_cells_of_one_layer_share_what_they_contract_more_along_it(comm):
    points, x = made(comm, "plane-strain", "simplices")
    growth = behind_a_front(x[:, :2], np.array([1.0, 0.0]))
    found = eigenstrain(points, points, growth, 500.0 + 2e3 * x[:, 0])
    own, excess = (growth.along(points) - each for each in (growth.across(points), found.volume))
    some = np.abs(own) > 1e-15
    assert np.ptp(own[some]) > 0.3 * np.abs(CONTRACTION)
    assert np.ptp(excess[some]) < 0.4 * np.ptp(own[some])


@every_kind
@pytest.mark.ranks
def test_along_a_front_the_solid_strains_and_the_volume_is_that_of_its_metal(comm, model, cells):
    """Where a cell has any solid, all of it contracts by da/3 along the front."""
    points, x = made(comm, model, cells)
    x = x[:, : 3 if model == "3d" else 2]
    growth = behind_a_front(x, DIRECTION)
    found = eigenstrain(points, points, growth, 500.0 + 2e3 * x @ DIRECTION[: x.shape[1]])
    volume = points.from_volumes(found.volume)
    strain = tensors(found.shape) + volume[:, None, None] / 3 * np.eye(3)
    np.testing.assert_allclose(np.trace(strain, axis1=1, axis2=2), volume, atol=1e-15)
    solid = points.from_volumes(growth.along(points)) < 0
    assert comm.allreduce(bool(solid.any() and not solid.all())) >= 1
    for along in (np.array([0.8, -0.6, 0.0]), np.array([0.0, 0.0, 1.0])):
        lengthened = np.einsum("i,pij,j->p", along, strain, along)
        np.testing.assert_allclose(lengthened, np.where(solid, CONTRACTION / 3, 0.0), atol=1e-15)
    # The slab loses what its nodes lose, however its cells share that.
    lost = (points.weights.ravel() @ volume)[None] if comm.size == 1 else None
    if lost is not None:
        expected = points.integrals([growth.contracted])
        np.testing.assert_allclose(lost, expected, rtol=1e-12)


@every_kind
def test_metal_that_contracts_alike_keeps_its_shape(comm, model, cells):
    points, x = made(comm, model, cells)
    even, nodes = np.full(len(x), CONTRACTION), len(x)
    for share in (1.0, 0.3):
        growth = Growth(np.full(nodes, share), share * even, even)
        found = eigenstrain(points, points, growth, 500.0 + 2e3 * x[:, 0])
        assert not found.shape.any()
        np.testing.assert_allclose(found.volume, CONTRACTION, rtol=1e-12)


def test_samples_inside_a_cell_know_how_much_of_it_has_contracted(comm):
    """Cells of which only samples bear lose the volume of those, and strain as they do."""
    points, x = made(comm, "plane-strain", "simplices")
    places = MetalPlaces(points, np.arange(points.cells, dtype=np.int32))
    count = len(x)
    depth = places.samples_from_nodes(x[:, 0])
    share = places.joined(np.zeros(count), (depth < 0.004).astype(float))
    growth = Growth(share, CONTRACTION * share, CONTRACTION * share)
    found = eigenstrain(points, places, growth, 500.0 + 2e3 * x[:, 0])
    some = places.volume_means(share) > 0
    assert some.any() and not some.all()
    np.testing.assert_allclose(found.shape[some, 1] + found.volume[some] / 3, CONTRACTION / 3)
    lost, expected = points.weights.sum(axis=1) @ found.volume, places.integrals([share])
    np.testing.assert_allclose(lost, CONTRACTION * expected[0], rtol=1e-12)


def test_a_front_without_a_direction_leaves_the_shape(comm):
    """Metal as warm all round has no layers: it contracts by the mean in all directions."""
    points, x = made(comm, "plane-strain", "simplices")
    growth = behind_a_front(x[:, :2], DIRECTION)
    found = eigenstrain(points, points, growth, np.full(len(x), 600.0))
    assert not found.shape.any() and found.volume.any()
