"""Pairs by smooth patch: numbers at edges and corners, normals and areas against single pairs."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.choice import Contact
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.pairs.patches import pairs_by_patch
from tests.castx.domain.interface_meshes import MESHES, NAMES, box, cup
from tests.contact_methods import AT_ONCE, sharp
from tests.elastic_bodies import body, elastic, everywhere, heat, problem

SHARP = math.radians(40)


@pytest.mark.ranks
@pytest.mark.parametrize("name", MESHES)
def test_patches_of_a_node_add_up(comm, name):
    mesh = MESHES[name](comm)
    single, several = node_pairs(mesh, *NAMES), pairs_by_patch(mesh, *NAMES, SHARP)
    size = mesh.bodies["casting"].nodes.dofmap.index_map.size_local
    areas = np.bincount(several.secondary_local, several.areas, size)
    np.testing.assert_allclose(areas[single.secondary_local], single.areas, rtol=1e-10)
    sums = np.zeros((size, several.points.shape[1]))
    np.add.at(sums, several.secondary_local, several.area_vectors)
    np.testing.assert_allclose(
        sums[single.secondary_local], single.area_vectors, atol=1e-10 * areas.max(initial=0.0)
    )
    by_node = dict(zip(single.secondary_nodes, single.primary_nodes, strict=True))
    assert all(by_node[s] == p for s, p in zip(several.secondary_nodes, several.primary_nodes,
                                               strict=True))
    numbers = everywhere(comm, several.numbering.numbers)
    assert len(np.unique(numbers)) == len(numbers)


def multiplicities(comm, pairs):
    """Return how many nodes have 1, 2, 3 … pairs."""
    return Counter(Counter(everywhere(comm, pairs.secondary_nodes).tolist()).values())


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_edges_have_two_and_corners_three(comm, cells):
    flat = pairs_by_patch(box(comm, "plane-strain", cells), *NAMES, SHARP)
    assert multiplicities(comm, flat) == {1: 2 * (3 + 1), 2: 4}
    solid = pairs_by_patch(box(comm, "3d", cells), *NAMES, SHARP)
    counts = multiplicities(comm, solid)
    assert (counts[2], counts[3]) == (4 * (3 + 3 + 1), 8)
    for vectors in (flat.normals, solid.normals):
        assert np.allclose(np.abs(vectors).max(axis=1), 1.0)


@pytest.mark.ranks
def test_a_curved_side_is_one_patch(comm):
    """Its facets enclose 20° in the coarse quarter; floor and side meet at 90°."""
    mesh = cup(comm, "3d", sector="quarter")
    pairs = pairs_by_patch(mesh, *NAMES, SHARP)
    points = everywhere(comm, pairs.points)
    counts = Counter(map(tuple, np.round(points, 9)))
    for (x, y, z), number in counts.items():
        edge = abs(z) < 1e-9 and abs(math.hypot(x, y) - 0.03) < 1e-6
        assert number == (2 if edge else 1)


def test_the_sharp_angle_decides(comm):
    mesh = cup(comm, "3d", sector="quarter")
    counts = [
        comm.allreduce(len(pairs_by_patch(mesh, *NAMES, math.radians(angle)).areas))
        for angle in (100, 40, 10)
    ]
    assert counts[0] < counts[1] < counts[2]
    assert counts[0] == comm.allreduce(len(node_pairs(mesh, *NAMES).areas))


@pytest.mark.parametrize("method", sharp(AT_ONCE))
def test_a_hot_box_presses_on_all_faces_of_its_mould(comm, method):
    """Rigid mould, ν = 0: E α ΔT on every face, edges and corners included, with their areas."""
    mesh = box(comm, "3d", "simplices")
    young, expansion, warming = 70e9, 2e-5, 10.0
    made = problem(
        mesh, {"casting": body(elastic(young, 0.0, expansion))}, {},
        [Contact(*NAMES, method, settings={"penalty": 1e16}, pairing=Pairing("patches"))],
        tolerance=1e-10,
    )  # fmt: skip
    heat(made, 20.0 + warming)
    made.equilibrium.solve(0.0)
    state = made.contact_states()[0]
    expected = young * expansion * warming
    share = 1e-3 if method == "penalty" else 1e-8
    np.testing.assert_allclose(state.pressure, expected, rtol=share)
    forces = everywhere(comm, state.force)
    faces = np.array([0.03 * 0.02, 0.04 * 0.02, 0.04 * 0.03])
    np.testing.assert_allclose(np.abs(forces).sum(axis=0), 2 * expected * faces, rtol=share)


def test_averaged_normals_hold_a_corner_less(comm):
    """Where the faces of a corner move in their planes, one mean normal binds them together."""
    mesh = box(comm, "plane-strain", "simplices")
    results = []
    for normals in ("averaged", "patches"):
        made = problem(
            mesh, {"casting": body(elastic(70e9, 0.3, 2e-5))}, {},
            [Contact(*NAMES, pairing=Pairing(normals))],
        )  # fmt: skip
        heat(made, lambda x: 20 + 1e3 * x[:, 0])
        made.equilibrium.solve(0.0)
        results.append(everywhere(comm, made.contact_states()[0].force))
    totals = [np.abs(forces).sum() for forces in results]
    assert abs(totals[0] / totals[1] - 1) > 1e-3
