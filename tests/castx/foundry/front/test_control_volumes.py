"""Control volumes: they fill the body and hold the part of each cell nearest to the node."""

from __future__ import annotations

import basix
import numpy as np
import pytest

from castx.domain.measures import nodal_volumes
from castx.foundry.front.control_volumes import ControlVolumes, corner_points
from tests.castx.fakes import cylinder_mesh, slab_mesh
from tests.castx.foundry.front.means import control_volume_means


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_control_volumes_fill_the_body(model, cells, comm):
    body = cylinder_mesh(comm, model, 8e-3, cells).bodies["mould"]
    volumes = ControlVolumes(body, model == "axisymmetric").volumes.sum()
    exact = nodal_volumes(body, model).sum() / (2.0 * np.pi if model == "axisymmetric" else 1.0)
    assert comm.allreduce(volumes) == pytest.approx(comm.allreduce(exact), rel=1e-12)


@pytest.mark.ranks
def test_means_are_those_of_many_points(comm):
    body = slab_mesh(comm, 5e-3).bodies["casting"]
    volumes = ControlVolumes(body)
    parts = volumes.around(np.ones(len(body.points), dtype=bool))

    def formula(x):
        return 3.0 - 200.0 * x[..., 0] + 50.0 * x[..., 1]

    positions = body.points[volumes.cell_nodes[parts[0]]]
    points = np.einsum("pqb,pbk->pqk", volumes.shapes[parts[1]], positions)
    exact = control_volume_means(body, formula, 96)
    np.testing.assert_allclose(volumes.means(parts, formula(points)), exact, atol=2e-3)


@pytest.mark.serial
@pytest.mark.parametrize("kind", ["triangle", "tetrahedron", "quadrilateral", "hexahedron"])
def test_the_points_of_a_corner_are_nearest_to_it_and_have_the_mean_of_its_part(kind):
    cell = getattr(basix.CellType, kind)
    corners = np.asarray(basix.geometry(cell))
    points, weights = corner_points(cell)
    assert weights.sum() * len(corners) == pytest.approx(basix.cell.volume(cell), rel=1e-14)
    rng = np.random.default_rng(3)
    drawn = rng.uniform(size=(200000, corners.shape[1]))
    if len(corners) == corners.shape[1] + 1:
        drawn = drawn[drawn.sum(axis=1) < 1.0]
        owner = np.column_stack([1.0 - drawn.sum(axis=1), drawn]).argmax(axis=1)
    else:
        owner = np.abs(drawn[:, None] - corners).sum(axis=2).argmin(axis=1)
    for number, of_corner in enumerate(points):
        mean = drawn[owner == number].mean(axis=0)
        np.testing.assert_allclose(of_corner.mean(axis=0), mean, atol=5e-3)
