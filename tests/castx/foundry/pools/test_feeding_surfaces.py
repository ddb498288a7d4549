"""Which nodes of a cylinder in a mould lie on a surface that feeds."""

from __future__ import annotations

from mpi4py import MPI

import pytest

from castx.foundry.pools.feeding_surfaces import FREE, FeedingNodes, FeedingSurfaces
from tests.castx.fakes import cylinder_mesh

FACING = {"casting/mould": "mould"}
HEIGHT, RADIUS = 0.04, 0.02


@pytest.fixture(scope="module")
def mesh():
    return cylinder_mesh(MPI.COMM_WORLD)


def nodes_of(mesh, surfaces):
    return FeedingNodes(mesh.bodies["casting"], mesh.model, surfaces)


def test_free_is_what_faces_nothing_and_is_not_held(mesh):
    r, z = mesh.bodies["casting"].points.T
    found = nodes_of(mesh, FeedingSurfaces(None, ("base",), FACING))
    assert found.any(["casting/mould"]).tolist() == (z > HEIGHT - 1e-9).tolist()
    bare = (z > HEIGHT - 1e-9) | (r > RADIUS - 1e-9)
    assert found.any([]).tolist() == bare.tolist()
    assert list(found.by_feeder([])) == [FREE]


def test_named_surfaces_are_feeders_of_their_own(mesh):
    z = mesh.bodies["casting"].points[:, 1]
    surfaces = FeedingSurfaces(("top", "base"))
    found = nodes_of(mesh, surfaces).by_feeder(["casting/mould"])
    assert tuple(found) == surfaces.feeders == ("top", "base")
    assert found["top"].tolist() == (z > HEIGHT - 1e-9).tolist()
    assert found["base"].tolist() == (z < 1e-9).tolist()
    assert not nodes_of(mesh, FeedingSurfaces(())).any([]).any()


def test_all_free_surfaces_are_one_feeder():
    assert FeedingSurfaces().feeders == (FREE,)
