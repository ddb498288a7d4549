"""Force and stiffness of a clamp on single cells, against integrals by hand."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem

from castx.forms import clamp, kinematics
from tests.forms.test_momentum import CORNERS, MODEL, cell, dimensions

pytestmark = pytest.mark.serial

DIRECTIONS = {2: np.array([0.6, -0.8]), 3: np.array([0.48, 0.6, -0.64])}


def facets(dimension: int) -> tuple[list[list[int]], list[float]]:
    """Return the corners of the facets of the cell, and their sizes."""
    points = CORNERS[dimension]
    found = [[j for j in range(dimension + 1) if j != i] for i in range(dimension + 1)]
    sizes = []
    for corners in found:
        edges = points[corners[1:]] - points[corners[0]]
        gram = np.linalg.det(edges @ edges.T)
        sizes.append(float(np.sqrt(gram)) / (1 if dimension == 2 else 2))
    return found, sizes


def spaces(dimension: int):
    """Return the vector space of the cell, and the numbers of its nodes in the order of CORNERS."""
    space = fem.functionspace(cell(dimension), ("Lagrange", 1, (dimension,)))
    points = space.tabulate_dof_coordinates()[:, :dimension]
    nodes = [int(np.linalg.norm(points - x, axis=1).argmin()) for x in CORNERS[dimension]]
    return space, nodes


def measure(dimension: int) -> kinematics.WeightedMeasure:
    x = ufl.SpatialCoordinate(cell(dimension))
    ds = ufl.Measure("ds", domain=cell(dimension))
    return kinematics.WeightedMeasure(kinematics.weight(MODEL[dimension], x), ds)


@dimensions
def test_the_force_is_spread_evenly(dimension):
    """(F/A) d times the share of each node of each facet."""
    space, nodes = spaces(dimension)
    d = DIRECTIONS[dimension]
    eta = ufl.TestFunction(space)
    form = clamp.clamp_work(eta, 7.0, ufl.as_vector(d.tolist()), measure(dimension))
    found = fem.assemble_vector(fem.form(form)).array.reshape(-1, dimension)[nodes]
    expected = np.zeros_like(found)
    for corners, size in zip(*facets(dimension), strict=True):
        expected[corners] += 7.0 * d * size / dimension
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@dimensions
def test_the_springs_resist_along_the_direction_alone(dimension):
    """(k/A) ∫ φ_i φ_j d dᵀ, with ∫ φ_i φ_j = size (1 + δ_ij)/(n (n + 1)) on a facet."""
    space, nodes = spaces(dimension)
    d = DIRECTIONS[dimension]
    eta, du = ufl.TestFunction(space), ufl.TrialFunction(space)
    form = clamp.backing_work(eta, du, 5.0, ufl.as_vector(d.tolist()), measure(dimension))
    K = fem.assemble_matrix(fem.form(form)).to_dense()
    order = np.array([n * dimension + i for n in nodes for i in range(dimension)])
    expected = np.zeros_like(K)
    for corners, size in zip(*facets(dimension), strict=True):
        for i in corners:
            for j in corners:
                mass = size * (1 + (i == j)) / (dimension * (dimension + 1))
                rows, columns = (slice(n * dimension, (n + 1) * dimension) for n in (i, j))
                expected[rows, columns] += 5.0 * mass * np.outer(d, d)
    np.testing.assert_allclose(K[np.ix_(order, order)], expected, atol=1e-12)


@dimensions
def test_a_frame_resists_in_all_directions_alike(dimension):
    """It is the sum of springs along the axes."""
    space, _ = spaces(dimension)
    eta, du = ufl.TestFunction(space), ufl.TrialFunction(space)
    ds = measure(dimension)
    frame = fem.assemble_matrix(fem.form(clamp.frame_work(eta, du, 5.0, ds))).to_dense()
    axes = [ufl.as_vector(e.tolist()) for e in np.eye(dimension)]
    forms = [fem.form(clamp.backing_work(eta, du, 5.0, axis, ds)) for axis in axes]
    expected = sum(fem.assemble_matrix(form).to_dense() for form in forms)
    np.testing.assert_allclose(frame, expected, atol=1e-12)
    assert np.linalg.matrix_rank(frame) >= dimension
