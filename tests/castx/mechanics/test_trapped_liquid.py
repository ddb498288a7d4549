"""Liquid that no free surface feeds, on a cylinder whose top is free."""

from __future__ import annotations

from functools import partial

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import BodyMesh, build_mesh
from castx.mechanics.trapped_liquid import TRAPPED_SHARE, FeedingPaths, NoPockets, Pockets
from tests.castx.mechanics.lone_bodies import MELTING, alone, begin, inside

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
    trapped = FeedingPaths(casting, "axisymmetric", ["mould", "base"]).trapped(core)
    assert total(casting, core) > 20
    assert np.array_equal(trapped, core)


def test_liquid_that_reaches_the_top_is_fed_on_any_number_of_ranks(casting) -> None:
    r, z = midpoints(casting).T
    column = (r < RADIUS / 3) & (z > HEIGHT / 4)
    pocket = (r > 0.6 * RADIUS) & (z > HEIGHT / 4) & (z < HEIGHT / 2)
    paths = FeedingPaths(casting, "axisymmetric", ["mould", "base"])
    trapped = paths.trapped(column | pocket)
    assert total(casting, pocket) > 5
    assert np.array_equal(trapped, pocket)


def test_the_surfaces_decide(casting) -> None:
    r, _ = midpoints(casting).T
    column = r < RADIUS / 3
    every = FeedingPaths(casting, "axisymmetric", ["mould", "base", "top"]).trapped(column)
    none = FeedingPaths(casting, "axisymmetric", ["mould"]).trapped(column)
    assert np.array_equal(every, column)
    assert not none.any()


def test_no_liquid_is_no_pocket(casting) -> None:
    nothing = np.zeros(len(midpoints(casting)), dtype=bool)
    assert not FeedingPaths(casting, "axisymmetric", ["mould"]).trapped(nothing).any()


def test_a_pocket_keeps_the_pressure_at_which_it_closed_and_books_its_volume(casting) -> None:
    r, z = midpoints(casting).T
    core = (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)
    column = core | ((r < RADIUS / 2) & (z > HEIGHT / 2))
    pockets = Pockets(casting, "axisymmetric", ["mould", "base"])
    nodes, cells = len(casting.points), len(r)
    pockets.update(column)
    pockets.commit(partial(np.full, nodes, -5e4), np.zeros(cells))
    assert pockets.volume == 0.0
    for pressure, dilatation in ((7e6, 1e-3), (9e6, 3e-3)):
        pockets.update(core)
        held = pockets.pressure.x.array[casting.nodes.dofmap.list[core].ravel()]
        assert np.allclose(held, -5e4, rtol=1e-14)
        pockets.commit(partial(np.full, nodes, pressure), np.full(cells, dilatation))
    area = casting.mesh.comm.allreduce(float(weighted_area(casting)[core[: owned(casting)]].sum()))
    assert pockets.volume == pytest.approx(3e-3 * area, rel=1e-12)


def test_solid_out_of_a_pocket_has_the_volume_of_its_birth(casting) -> None:
    """Melting in a pocket frees it again, melting where liquid follows takes it away."""
    r, z = midpoints(casting).T
    core = (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)
    shrunk = core & (r < RADIUS / 4)
    pockets = Pockets(casting, "axisymmetric", ["mould", "base"])
    no_pressure, nothing = partial(np.full, len(casting.points), 0.0), np.zeros(len(r))
    steps = [(core, 2e-3), (shrunk, 5e-3), (shrunk, 4e-3), (np.zeros(len(r), dtype=bool), 1e-3)]
    for liquid, dilatation in steps:
        pockets.update(liquid)
        pockets.commit(no_pressure, nothing + dilatation)
    ring = core & ~shrunk
    expected = np.where(ring, 2e-3, np.where(shrunk, 4e-3, 0.0))
    assert np.allclose(pockets.birth_volume, expected, rtol=1e-14)
    pockets.update(shrunk)
    assert np.allclose(pockets.birth_volume, np.where(shrunk, 0.0, expected), rtol=1e-14)
    pockets.update(r < RADIUS)
    pockets.commit(no_pressure, nothing)
    pockets.update(~np.ones(len(r), dtype=bool))
    assert not pockets.birth_volume.any()


def test_a_pocket_that_is_closed_from_the_start_carries_its_weight(casting) -> None:
    """Liquid that fills a closed box is at rest, with the pressure of its depth."""
    everywhere = np.ones(len(midpoints(casting)), dtype=bool)
    shut = ["mould", "base", "top"]
    pockets = Pockets(casting, "axisymmetric", shut, (0.0, -2700 * 9.81))
    assert pockets.update(everywhere).all()
    depth = HEIGHT - casting.points[:, 1]
    assert np.allclose(pockets.pressure.x.array, -2700 * 9.81 * depth, rtol=1e-12, atol=1e-9)
    weightless = Pockets(casting, "axisymmetric", shut)
    assert weightless.update(everywhere).all() and not weightless.pressure.x.array.any()


def shut_slab(comm, properties, **more):
    """Return a slab that is closed all around and carries its weight."""
    around = ("wall", "far", "bottom", "top")
    return alone(
        comm, properties=properties, closed=around, body_force=(0.0, -26.5e3), **more
    )


def test_trapped_liquid_balances_its_weight_without_moving(comm):
    """Its pressure acts as a load, and p = p_trapped replaces the continuity equation."""
    part = shut_slab(comm, MELTING, starts_liquid=True)
    begin(part, 640.0, 0.0)
    solid = part.material.conditions.solid_compressibility
    np.testing.assert_allclose(part.material.compressibility.x.array, TRAPPED_SHARE * solid)
    depth = 0.01 - part.mesh.points[:, 1]
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 2] = -26.5e3 * depth / part.unknowns.pressure_scale
    residual = part.residual().reshape(-1, part.block_size)
    force = 26.5e3 * 0.01 * 0.005
    assert np.abs(residual[:, :2] * inside(part)[:, None]).max(initial=0.0) < 1e-10 * force
    values[:, 2] *= 2.0
    wrong = part.residual().reshape(-1, part.block_size)
    assert np.abs(residual[:, 2]).max(initial=0.0) < 1e-9 * comm.allreduce(
        np.abs(wrong[:, 2]).max(initial=0.0), op=MPI.MAX
    )
    np.testing.assert_allclose(wrong[:, :2], residual[:, :2], atol=1e-12 * force)


def test_pressures_of_trapped_cells_are_means_of_their_nodes(casting) -> None:
    r, z = midpoints(casting).T
    core = (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)
    pockets = Pockets(casting, "axisymmetric", ["mould", "base"])
    pressure = 1e5 * (1.0 + casting.points[:, 1] / HEIGHT)
    pockets.update(r < RADIUS)
    pockets.commit(partial(np.copy, pressure), np.zeros(len(r)))
    pockets.update(core)
    expected = np.where(core, 1e5 * (1.0 + z / HEIGHT), np.nan)
    np.testing.assert_allclose(pockets.cell_pressures(), expected, rtol=1e-12)


def test_a_body_that_never_is_a_liquid_traps_nothing(comm) -> None:
    part = shut_slab(comm, {})
    begin(part, 640.0, 0.0)
    assert part.unfed_volume is None
    assert list(part.stateful_parts()) == ["points"]
    before = part.material.compressibility.x.array.copy()
    stands_for = NoPockets(len(part.cell_nodes))
    stands_for.begin(part.material)
    np.testing.assert_array_equal(part.material.compressibility.x.array, before)
    assert np.isnan(stands_for.cell_pressures()).all()


def owned(body: BodyMesh) -> int:
    return body.mesh.topology.index_map(2).size_local


def weighted_area(body: BodyMesh) -> np.ndarray:
    """Volumes of the owned cells by the rule of Pappus."""
    corners = body.points[body.nodes.dofmap.list][: owned(body)]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    return 2 * np.pi * corners[:, :, 0].mean(axis=1) * areas
