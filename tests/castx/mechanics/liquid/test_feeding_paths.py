"""Liquid that no free surface feeds, on a cylinder whose top is free."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import BodyMesh, build_mesh
from castx.mechanics.liquid.feeding_paths import FeedingPaths

RADIUS, HEIGHT, SIZE = 0.03, 0.06, 0.004


@pytest.fixture(scope="module")
def casting() -> BodyMesh:
    sizes = {"radius": RADIUS, "height": HEIGHT, "wall": 0.01, "size": SIZE}
    description = {"model": "axisymmetric", "generator": "cylinder_in_mould", **sizes}
    geometry = Geometry.model_validate(description)
    return build_mesh(geometry, ["casting", "mould"], MPI.COMM_WORLD).bodies["casting"]


def midpoints(body: BodyMesh) -> np.ndarray:
    return body.points[body.nodes.dofmap.list].mean(axis=1)


def total(body: BodyMesh, cells: np.ndarray) -> int:
    owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
    return body.mesh.comm.allreduce(int(np.count_nonzero(cells[:owned])))


def test_liquid_in_the_middle_is_trapped(casting) -> None:
    r, z = midpoints(casting).T
    core = (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)
    trapped = FeedingPaths(casting, "axisymmetric", ["mould", "base"]).pockets(core) >= 0
    assert total(casting, core) > 20
    assert np.array_equal(trapped, core)


@pytest.mark.ranks
def test_liquid_that_reaches_the_top_is_fed_on_any_number_of_ranks(casting) -> None:
    r, z = midpoints(casting).T
    column = (r < RADIUS / 3) & (z > HEIGHT / 4)
    pocket = (r > 0.6 * RADIUS) & (z > HEIGHT / 4) & (z < HEIGHT / 2)
    paths = FeedingPaths(casting, "axisymmetric", ["mould", "base"])
    trapped = paths.pockets(column | pocket) >= 0
    assert total(casting, pocket) > 5
    assert np.array_equal(trapped, pocket)


def test_the_surfaces_decide(casting) -> None:
    r, _ = midpoints(casting).T
    column = r < RADIUS / 3
    every = FeedingPaths(casting, "axisymmetric", ["mould", "base", "top"]).pockets(column) >= 0
    none = FeedingPaths(casting, "axisymmetric", ["mould"]).pockets(column) >= 0
    assert np.array_equal(every, column)
    assert not none.any()


@pytest.mark.ranks
def test_no_liquid_is_no_pocket(casting) -> None:
    nothing = np.zeros(len(midpoints(casting)), dtype=bool)
    assert np.all(FeedingPaths(casting, "axisymmetric", ["mould"]).pockets(nothing) == -1)


@pytest.mark.ranks
def test_pockets_are_numbered_alike_on_all_ranks(casting) -> None:
    """Two pockets that stretch over the whole height, and so over ranks, and a fed column."""
    r, z = midpoints(casting).T
    inner, outer = r < RADIUS / 4, (r > RADIUS / 2) & (r < 0.8 * RADIUS)
    low = z < 0.8 * HEIGHT
    paths = FeedingPaths(casting, "axisymmetric", ["mould", "base"])
    pockets = paths.pockets((inner | outer) & low)
    assert np.array_equal(pockets >= 0, (inner | outer) & low)
    comm = casting.mesh.comm
    found = comm.allgather([set(pockets[part & low].tolist()) for part in (inner, outer)])
    inside, outside = (set().union(*sets) for sets in zip(*found, strict=True))
    assert len(inside) == len(outside) == 1
    assert inside | outside == {0, 1}
    fed = paths.pockets(inner | (outer & low))
    assert (fed[inner] == -1).all() and (fed[outer & low] == 0).all()
