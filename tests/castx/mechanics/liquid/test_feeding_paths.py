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


def wet_cells(body: BodyMesh, wet: np.ndarray) -> np.ndarray:
    """Return which cells have a node where liquid can flow."""
    return wet[body.nodes.dofmap.list].any(axis=1)


def pockets(body: BodyMesh, wet: np.ndarray, closed: list[str]) -> np.ndarray:
    """Return the pockets where nodes have solid fractions of 0.6, and just more elsewhere."""
    fraction = np.where(wet, 0.6, 0.6 + 1e-15)
    return FeedingPaths(body, "axisymmetric", closed).pockets(fraction, 0.6)


def total(body: BodyMesh, cells: np.ndarray) -> int:
    owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
    return body.mesh.comm.allreduce(int(np.count_nonzero(cells[:owned])))


def places(body: BodyMesh) -> tuple[np.ndarray, np.ndarray]:
    return body.points[:, 0], body.points[:, 1]


def test_liquid_in_the_middle_is_trapped(casting) -> None:
    r, z = places(casting)
    core = (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)
    cells = wet_cells(casting, core)
    assert total(casting, cells) > 20
    assert np.array_equal(pockets(casting, core, ["mould", "base"]) >= 0, cells)


@pytest.mark.ranks
def test_liquid_that_reaches_the_top_is_fed_on_any_number_of_ranks(casting) -> None:
    r, z = places(casting)
    column = (r < RADIUS / 3) & (z > HEIGHT / 4)
    pocket = (r > 0.6 * RADIUS) & (z > HEIGHT / 4) & (z < HEIGHT / 2)
    trapped = pockets(casting, column | pocket, ["mould", "base"]) >= 0
    assert total(casting, wet_cells(casting, pocket)) > 5
    assert np.array_equal(trapped, wet_cells(casting, pocket))


@pytest.mark.ranks
def test_liquid_is_fed_until_the_last_node_of_the_surface_is_solid(casting) -> None:
    """A skin of a node closes the top, and one node left liquid keeps it open."""
    r, z = places(casting)
    column, surface = r < RADIUS / 3, z > HEIGHT - 1e-6
    shut = column & ~surface
    assert (pockets(casting, shut, ["mould", "base"]) >= 0).any() or not shut.any()
    one = shut | (column & surface & (r < 1e-6))
    assert not (pockets(casting, one, ["mould", "base"]) >= 0).any()


@pytest.mark.ranks
def test_a_layer_of_solid_nodes_parts_liquid_though_cells_meet_there(casting) -> None:
    r, z = places(casting)
    layer = np.abs(z - HEIGHT / 2) < 0.51 * SIZE
    inside = (r < RADIUS / 2) & (z > HEIGHT / 4) & (z < 0.75 * HEIGHT)
    whole, parted = (pockets(casting, wet, ["mould", "base"]) for wet in (inside, inside & ~layer))
    count = [1 + casting.mesh.comm.allreduce(int(p.max(initial=-1)), op=MPI.MAX)
             for p in (whole, parted)]  # fmt: skip
    assert count == [1, 2]


def test_the_surfaces_decide(casting) -> None:
    r, _ = places(casting)
    column = r < RADIUS / 3
    every = pockets(casting, column, ["mould", "base", "top"]) >= 0
    assert np.array_equal(every, wet_cells(casting, column))
    assert not (pockets(casting, column, ["mould"]) >= 0).any()


@pytest.mark.ranks
def test_no_liquid_is_no_pocket(casting) -> None:
    nothing = np.zeros(len(casting.points), dtype=bool)
    assert np.all(pockets(casting, nothing, ["mould"]) == -1)


@pytest.mark.ranks
def test_in_pure_metal_liquid_flows_until_all_is_solid(casting) -> None:
    paths = FeedingPaths(casting, "axisymmetric", ["mould", "base", "top"])
    nearly = np.full(len(casting.points), 1.0 - 1e-12)
    assert np.all(paths.pockets(nearly, 1.0) == 0)
    assert np.all(paths.pockets(np.ones(len(nearly)), 1.0) == -1)


@pytest.mark.ranks
def test_pockets_are_numbered_alike_on_all_ranks(casting) -> None:
    """Two pockets that stretch over the whole height, and so over ranks, and a fed column."""
    r, z = places(casting)
    inner, outer = r < RADIUS / 4, (r > RADIUS / 2) & (r < 0.8 * RADIUS)
    low = z < 0.8 * HEIGHT
    found = pockets(casting, (inner | outer) & low, ["mould", "base"])
    parts = [wet_cells(casting, part & low) for part in (inner, outer)]
    assert np.array_equal(found >= 0, parts[0] | parts[1])
    comm = casting.mesh.comm
    numbers = comm.allgather([set(found[part].tolist()) for part in parts])
    inside, outside = (set().union(*sets) for sets in zip(*numbers, strict=True))
    assert len(inside) == len(outside) == 1
    assert inside | outside == {0, 1}
    fed = pockets(casting, inner | (outer & low), ["mould", "base"])
    assert (fed[wet_cells(casting, inner)] == -1).all() and (fed[parts[1]] == 0).all()


def frozen_at(start: np.ndarray, share: np.ndarray | float, fed_until: float) -> np.ndarray:
    """Return fractions at the end of a step in which they pass a limit after a share of it."""
    return start + (fed_until + 1e-9 - start) / share


def column_below_the_top(body: BodyMesh) -> tuple[np.ndarray, np.ndarray, np.ndarray, FeedingPaths]:
    """Return the nodes of a column and of the top, solid fractions 0.3 in the column, and paths."""
    r, z = places(body)
    column = r < RADIUS / 3
    paths = FeedingPaths(body, "axisymmetric", ["mould", "base"])
    return column, z > HEIGHT - 1e-6, np.where(column, 0.3, 1.0), paths


@pytest.mark.ranks
def test_a_pool_that_is_cut_off_in_a_step_says_since_when(casting) -> None:
    """A skin closes the top of a column after a share of the step, and walls freeze at its end."""
    column, surface, before, paths = column_below_the_top(casting)
    fed = paths.pockets(before, 0.6) < 0
    inside = wet_cells(casting, column & ~surface)
    for share in np.linspace(0.02, 0.98, 25):
        after = np.where(column & surface, frozen_at(before, share, 0.6), before)
        cut = paths.cut_off(before, after, 0.6, fed)
        assert np.array_equal(cut.region >= 0, inside)
        np.testing.assert_allclose(cut.moment[inside], share, atol=1e-6)
        assert np.all(cut.moment[~inside] == 0.0)
        assert np.array_equal(cut.group >= 0, inside)
        assert np.all(cut.group < cut.groups)


@pytest.mark.ranks
def test_what_freezes_behind_the_cut_is_fed_until_then(casting) -> None:
    """The lower half of the column freezes at 0.8 of the step; the cut is at 0.3 of it."""
    column, surface, before, paths = column_below_the_top(casting)
    low = places(casting)[1] < HEIGHT / 2
    fed = paths.pockets(before, 0.6) < 0
    after = np.where(column & surface, frozen_at(before, 0.3, 0.6), before)
    after = np.where(column & low, frozen_at(before, 0.8, 0.6), after)
    cut = paths.cut_off(before, after, 0.6, fed)
    upper = wet_cells(casting, column & ~low & ~surface)
    lower = wet_cells(casting, column & low) & ~upper
    assert total(casting, lower) > 10
    assert np.all(cut.region[lower] == -1)
    np.testing.assert_allclose(cut.moment[upper | lower], 0.3, atol=1e-6)
    assert len(np.unique(cut.group[upper | lower])) <= 1


@pytest.mark.ranks
def test_a_pool_that_is_cut_off_and_freezes_in_one_step_is_dated(casting) -> None:
    """All freezes: the surface at 0.4 of the step, the column below it at 0.9."""
    column, surface, before, paths = column_below_the_top(casting)
    after = np.where(column, frozen_at(before, np.where(surface, 0.4, 0.9), 0.6), before)
    cut = paths.cut_off(before, after, 0.6, paths.pockets(before, 0.6) < 0)
    inside = wet_cells(casting, column & ~surface)
    assert np.all(cut.region == -1)
    assert np.array_equal(cut.group >= 0, inside)
    np.testing.assert_allclose(cut.moment[inside], 0.4, atol=1e-6)


@pytest.mark.ranks
def test_pools_part_from_the_surface_each_at_its_moment(casting) -> None:
    """A lower pool is cut off at 0.2 of the step, an upper one at 0.7."""
    column, surface, before, paths = column_below_the_top(casting)
    z = places(casting)[1]
    neck = np.abs(z - HEIGHT / 2) < 0.6 * SIZE
    after = np.where(column & surface, frozen_at(before, 0.7, 0.6), before)
    after = np.where(column & neck, frozen_at(before, 0.2, 0.6), after)
    cut = paths.cut_off(before, after, 0.6, paths.pockets(before, 0.6) < 0)
    upper = wet_cells(casting, column & ~surface & ~neck & (z > HEIGHT / 2))
    lower = wet_cells(casting, column & ~neck & (z < HEIGHT / 2))
    assert min(total(casting, upper), total(casting, lower)) > 10
    np.testing.assert_allclose(cut.moment[upper], 0.7, atol=1e-6)
    np.testing.assert_allclose(cut.moment[lower], 0.2, atol=1e-6)
    assert not set(cut.group[upper]) & set(cut.group[lower])


@pytest.mark.ranks
def test_pure_metal_is_cut_off_in_the_middle_of_the_step(casting) -> None:
    """Its solid fraction is one at the end, and was one from some moment on."""
    column, surface, before, paths = column_below_the_top(casting)
    after = np.where(column & surface, 1.0, before)
    cut = paths.cut_off(before, after, 1.0, paths.pockets(before, 1.0) < 0)
    assert np.all(cut.moment[cut.region >= 0] == 0.5)


@pytest.mark.ranks
def test_regions_that_were_cut_off_before_or_are_fed_have_no_moment(casting) -> None:
    r, z = places(casting)
    core = (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)
    before, after = (np.where(core, f, 1.0) for f in (0.2, 0.5))
    paths = FeedingPaths(casting, "axisymmetric", ["mould", "base"])
    region = paths.pockets(before, 0.6)
    cut = paths.cut_off(before, after, 0.6, region < 0)
    assert np.array_equal(cut.region, region)
    assert cut.groups == 0
    assert np.all(cut.moment == 0.0)
    assert np.all(cut.group == -1)
