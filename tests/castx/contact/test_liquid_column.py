"""Pressure of liquid columns in regions that several ranks share."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.liquid_column import column_pressure
from castx.mechanics.liquid.regions import CellRegions
from tests.elastic_bodies import everywhere, generated

WEIGHT = 2.0


@pytest.mark.ranks
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_two_pools_have_their_own_level(comm, model):
    """A wall of solid parts a box: left of it liquid stands up to 20 mm, right of it to 10 mm."""
    sizes = {"length": 0.04, "width": 0.02, "size": 0.0025}
    if model == "3d":
        sizes |= {"width": 0.005, "depth": 0.02}
    mesh = generated(comm, model, "slab", ["casting"], **sizes).bodies["casting"]
    x, up = mesh.points[:, 0], mesh.points[:, -1]
    corners = mesh.points[mesh.nodes.dofmap.list]
    left = corners[:, :, 0].max(axis=1) < 0.0151
    right = (corners[:, :, 0].min(axis=1) > 0.0249) & (corners[:, :, -1].max(axis=1) < 0.0101)
    found = column_pressure(CellRegions(mesh), left | right, -WEIGHT * up)
    wanted = np.where(x < 0.0151, WEIGHT * (0.02 - up), 0.0)
    wanted = np.where((x > 0.0249) & (up < 0.0101), WEIGHT * (0.01 - up), wanted)
    # Nodes of other ranks may have their liquid there.
    own = np.arange(mesh.nodes.dofmap.index_map.size_local)
    touched = np.zeros(len(up), dtype=bool)
    touched[mesh.nodes.dofmap.list[left | right].ravel()] = True
    np.testing.assert_allclose(found[touched], wanted[touched], atol=1e-15)
    assert np.all(found[~touched] == 0.0)
    assert everywhere(comm, found[own]).max() == pytest.approx(WEIGHT * 0.02)


@pytest.mark.ranks
def test_no_liquid_has_no_pressure(comm):
    mesh = generated(comm, "plane-strain", "slab", ["casting"], length=0.01, width=0.01, size=0.005)
    body = mesh.bodies["casting"]
    none = np.zeros(len(body.nodes.dofmap.list), dtype=bool)
    assert np.all(column_pressure(CellRegions(body), none, body.points[:, 1]) == 0.0)
