"""Values recovered at the nodes: linear functions exactly, at the surface and beside others."""

from __future__ import annotations

import numpy as np
import pytest

from castx.discretisation.recovery import PatchRecovery
from tests.castx.fakes import cylinder_mesh
from tests.partitions import PARTITION, on_the_last

SLOPES = np.array([[2.0, -1.0, 0.5], [0.3, 4.0, -2.0]])
KINDS = [("axisymmetric", "simplices"), ("axisymmetric", "quadrilaterals"), ("3d", "simplices")]


def linear(points):
    """Return two linear functions of the place, (points, 2)."""
    return 1.0 + points @ SLOPES[:, : points.shape[1]].T


def middles(body):
    return body.points[body.nodes.dofmap.list].mean(axis=1)


def check(comm, model, cells):
    mesh = cylinder_mesh(comm, model, 1e-2 if model == "3d" else 5e-3, cells)
    for body in mesh.bodies.values():
        found = PatchRecovery(body).at_nodes(linear(middles(body)))
        np.testing.assert_allclose(found, linear(body.points), rtol=1e-9)


@pytest.mark.ranks
@pytest.mark.parametrize("model, cells", KINDS)
def test_linear_functions_are_recovered_to_the_surface(comm, model, cells):
    check(comm, model, cells)


@pytest.mark.ranks
def test_linear_functions_are_recovered_with_ranks_without_cells(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    check(comm, *KINDS[0])


@pytest.mark.ranks
def test_cells_that_do_not_count_are_as_if_not_there(comm):
    body = cylinder_mesh(comm, size=3e-3).bodies["casting"]
    places = middles(body)
    counting = places[:, 1] < 0.02
    values = np.where(counting[:, None], linear(places), 1e6)
    found = PatchRecovery(body, counting).at_nodes(values)
    inside = body.points[:, 1] < 0.02 - 3e-3
    assert inside.any() or comm.size > 1
    np.testing.assert_allclose(found[inside], linear(body.points[inside]), rtol=1e-9)
    assert np.abs(found).max(initial=0.0) < 10.0


@pytest.mark.serial
def test_recovered_values_are_an_order_better_than_cells(comm):
    errors = []
    for size in (5e-3, 2.5e-3):
        body = cylinder_mesh(comm, size=size).bodies["casting"]
        curved = np.sin(100.0 * middles(body)[:, :1])
        found = PatchRecovery(body).at_nodes(curved)[:, 0]
        errors.append(np.abs(found - np.sin(100.0 * body.points[:, 0])).max())
    assert errors[0] < 0.1 and errors[1] < 0.4 * errors[0]
