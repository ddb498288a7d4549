"""Pressures of pockets at depths, on a cylinder of aluminium."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.arrays import IntArray
from castx.case.geometry import Geometry
from castx.domain.mesh import BodyMesh, build_mesh
from castx.mechanics.liquid.content import Content
from castx.mechanics.liquid.feeding_paths import CutOff
from castx.mechanics.liquid.pressures import PocketPressures

RADIUS, HEIGHT, WEIGHT = 0.03, 0.06, 2700 * 9.81


@pytest.fixture(scope="module")
def casting() -> BodyMesh:
    sizes = {"radius": RADIUS, "height": HEIGHT, "wall": 0.01, "size": 0.005}
    description = {"model": "axisymmetric", "generator": "cylinder_in_mould", **sizes}
    geometry = Geometry.model_validate(description)
    return build_mesh(geometry, ["casting", "mould"], MPI.COMM_WORLD).bodies["casting"]


def pockets_of(body: BodyMesh, *pockets: np.ndarray) -> Content:
    """Return the content of these pockets, trapped in the second step only."""
    numbering, nothing = body.cell_numbering, np.zeros(len(body.nodes.dofmap.list))
    content = Content(body.mesh.comm, numbering, np.ones(numbering.owned))
    pocket: IntArray = np.full(len(nothing), -1, dtype=np.int32)
    content.begin(CutOff.throughout(pocket), pocket < 0, nothing, nothing, nothing)
    for number, cells in enumerate(pockets):
        pocket = np.where(cells, number, pocket).astype(np.int32)
    content.begin(CutOff.throughout(pocket), pocket >= 0, nothing, nothing, nothing)
    return content


def test_pores_open_first_at_the_top_of_each_pocket(casting) -> None:
    corners = casting.nodes.dofmap.list
    z = casting.points[corners].mean(axis=1)[:, 1]
    low, high = z < 0.4 * HEIGHT, z > 0.6 * HEIGHT
    pressures = PocketPressures(casting, -WEIGHT * casting.points[:, 1], 2e5)
    pressures.begin(pockets_of(casting, low, high))
    tops = [
        casting.mesh.comm.allreduce(casting.points[corners[part], 1].max(initial=0), op=MPI.MAX)
        for part in (low, high)
    ]
    assert tops[1] == pytest.approx(HEIGHT) and tops[0] < 0.5 * HEIGHT
    for part, top in zip((low, high), tops, strict=True):
        depth = top - casting.points[corners[part], 1]
        np.testing.assert_allclose(pressures.limit[corners[part]], 2e5 - WEIGHT * depth, rtol=1e-12)


@pytest.mark.ranks
def test_at_the_start_liquid_is_at_rest_and_later_a_pocket_begins_where_it_was(casting) -> None:
    nodes = len(casting.points)
    everything = np.ones(len(casting.nodes.dofmap.list), dtype=bool)
    pressures = PocketPressures(casting, -WEIGHT * casting.points[:, 1], 0.0)
    depth = HEIGHT - casting.points[:, 1]
    np.testing.assert_allclose(pressures.reference, -WEIGHT * depth, rtol=1e-12, atol=1e-9)
    pressures.commit(np.full(nodes, -3e5))
    pressures.begin(pockets_of(casting, everything))
    np.testing.assert_array_equal(pressures.reference, -3e5)
    # The pressure of a pocket acts with that of depth, of which it takes over the mean alone.
    for excess in (0.0, 7e5):
        acting = pressures.acting(np.array([excess]))
        np.testing.assert_allclose(acting, excess - WEIGHT * depth, rtol=1e-12, atol=1e-6)
    volume = np.ones(len(everything))[: casting.cell_numbering.owned]
    over = (-3e5 + WEIGHT * depth)[casting.nodes.dofmap.list].mean(axis=1)[: len(volume)]
    mean = casting.mesh.comm.allreduce(over.sum()) / casting.mesh.comm.allreduce(volume.sum())
    np.testing.assert_allclose(pressures.at_closing, [mean], rtol=1e-12)
    other = PocketPressures(casting, -WEIGHT * casting.points[:, 1], 0.0)
    other.restore({name: saved.values for name, saved in pressures.saved().items()})
    other.begin(pockets_of(casting, everything))
    np.testing.assert_array_equal(other.reference, -3e5)


@pytest.mark.ranks
def test_each_pocket_has_its_own_pressure_and_other_nodes_their_references(casting) -> None:
    corners = casting.nodes.dofmap.list
    z = casting.points[corners].mean(axis=1)[:, 1]
    low, high = z < 0.4 * HEIGHT, z > 0.6 * HEIGHT
    pressures = PocketPressures(casting, 0.0, 2e5)
    pressures.commit(np.full(len(casting.points), -1e4))
    pressures.begin(pockets_of(casting, low, high))
    np.testing.assert_allclose(pressures.at_closing, -2.1e5, rtol=1e-14)
    acting = pressures.acting(np.array([-3e5, 1e5]))
    expected = pressures.reference.copy()
    expected[corners[low]], expected[corners[high]] = -1e5, 3e5
    np.testing.assert_allclose(acting, expected, rtol=1e-12)
    between = np.setdiff1d(np.arange(len(acting)), corners[low | high])
    total = casting.mesh.comm.allreduce(len(between))
    assert total > 0 and (acting[between] == pressures.reference[between]).all()
    np.testing.assert_array_equal(pressures.of_cells(acting)[low], -1e5)


@pytest.mark.ranks
def test_without_a_potential_there_is_no_depth(casting) -> None:
    pressures = PocketPressures(casting, 0.0, 1e4)
    pressures.begin(pockets_of(casting, np.ones(len(casting.nodes.dofmap.list), dtype=bool)))
    np.testing.assert_array_equal(pressures.limit, 1e4)
