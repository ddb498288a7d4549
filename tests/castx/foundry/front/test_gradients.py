"""Recovery of the magnitude of gradients: exact for linear fields, a mean by volume elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
import ufl
from dolfinx import fem

from castx.foundry.front.gradients import Steepness, midpoint_gradients
from tests.castx.fakes import cylinder_mesh


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_steepness_is_exact_for_linear_fields_and_sees_weights(cells, comm):
    mesh = cylinder_mesh(comm, "3d", 8e-3, cells)
    body = mesh.bodies["mould"]
    steepness = Steepness(body)
    points = body.nodes.tabulate_dof_coordinates()
    in_cells = steepness.in_cells(points @ np.array([3.0, -4.0, 12.0]))
    np.testing.assert_allclose(in_cells, 13.0)
    ones = np.ones_like(in_cells)
    np.testing.assert_allclose(steepness.at_nodes(in_cells, ones), 13.0)
    assert np.isnan(steepness.at_nodes(in_cells, 0.0 * ones)).all()
    in_cells[::2] = np.nan
    np.testing.assert_allclose(
        np.nan_to_num(steepness.at_nodes(in_cells, np.isfinite(in_cells) * 1.0), nan=13.0), 13.0
    )


@pytest.mark.serial
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_a_node_has_the_mean_of_its_cells_by_volume(cells, comm):
    body = cylinder_mesh(comm, size=1e-2, cells=cells).bodies["casting"]
    steepness, nodes = Steepness(body), len(body.points)
    rng = np.random.default_rng(2)
    in_cells = rng.uniform(1.0, 2.0, len(steepness.cell_nodes))
    volumes = polygon_areas(body.points[steepness.cell_nodes])
    expected = np.zeros(nodes)
    for node in range(nodes):
        round_it = (steepness.cell_nodes == node).any(axis=1)
        expected[node] = np.average(in_cells[round_it], weights=volumes[round_it])
    found = steepness.at_nodes(in_cells, np.ones(len(in_cells)))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def polygon_areas(corners: np.ndarray) -> np.ndarray:
    """Return the areas of polygons with corners (cells, nodes, 2) in the order of DOLFINx."""
    if corners.shape[1] == 4:
        corners = corners[:, [0, 1, 3, 2]]
    x, y = corners[..., 0], corners[..., 1]
    cross = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
    return 0.5 * np.abs(cross.sum(axis=1))


@pytest.mark.serial
def test_gradients_of_basis_functions_sum_to_zero_and_reproduce_a_plane(comm):
    body = cylinder_mesh(comm, size=1e-2).bodies["casting"]
    corners = body.points[body.nodes.dofmap.list]
    gradients, volumes = midpoint_gradients(body.nodes, corners)
    np.testing.assert_allclose(gradients.sum(axis=1), 0.0, atol=1e-9)
    slopes = np.einsum("cak,ca->ck", gradients, corners @ np.array([2.0, -3.0]))
    np.testing.assert_allclose(slopes, np.tile([2.0, -3.0], (len(slopes), 1)), rtol=1e-10)
    one = fem.Constant(body.mesh, 1.0)
    total = fem.assemble_scalar(fem.form(one * ufl.dx(body.mesh)))
    assert volumes.sum() == pytest.approx(total, rel=1e-12)
