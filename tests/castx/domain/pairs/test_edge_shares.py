"""Shares of pairs in edges: whole areas, and pressures that they carry exactly."""

from __future__ import annotations

import math

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.domain.pairs.edge_shares import edge_shares
from castx.domain.pairs.facet_pairs import facet_pairs
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.pairs.pairing import Facing, pairs_of
from castx.domain.pairs.patches import pairs_by_patch
from castx.domain.surface_facets import surface_facets
from castx.meshes.model import everything_else, fill_model, plane
from castx.meshes.structured import grid
from tests.castx.domain.interface_meshes import MESHES, NAMES
from tests.elastic_bodies import drawn, everywhere
from tests.partitions import PARTITION, scattered, thinly_scattered

pytestmark = pytest.mark.ranks

SHARP = math.radians(40)
SIMPLICES = ("box", "box in space", "cup", "cup in space")


def rule_of(mesh, patches: bool):
    """Return the pairs of a mesh, one or several at an edge, and their shares."""
    pairs = pairs_by_patch(mesh, *NAMES, SHARP) if patches else node_pairs(mesh, *NAMES)
    facets = facet_pairs(mesh, pairs, SHARP if patches else None)
    return pairs, edge_shares(facets, pairs, mesh.model)


@pytest.mark.parametrize("patches", [False, True])
@pytest.mark.parametrize("name", SIMPLICES)
def test_all_bubbles_have_their_area_once(comm, name, patches):
    """That of a line is two thirds of its length; the three of a triangle have all of its area."""
    mesh = MESHES[name](comm)
    pairs, shares = rule_of(mesh, patches)
    whole = 1.0 if mesh.model == "3d" else 2 / 3
    expected = whole * comm.allreduce(pairs.area_vectors.sum(axis=0))
    size = comm.allreduce(float(pairs.areas.sum()))
    found = comm.allreduce(shares.areas @ shares.normals)
    np.testing.assert_allclose(found, expected, atol=1e-12 * size)


def of_facets(facets, pressure):
    """Return ∫ b p dS of the edges and ∫ φ p dS of the corners of flat facets in closed form.

    Args:
        facets: lines or triangles.
        pressure: at their corners.
    """
    area, total = facets.areas.sum(axis=1), pressure.sum(axis=1)
    if facets.kind.dimension == 1:
        ends = np.array([[0, 1]])
        bubbles = (area * total / 3)[:, None]
        corners = area[:, None] * (pressure + total[:, None]) / 6
    else:
        ends = facets.kind.faces
        bubbles = area[:, None] * (total[:, None] + pressure[:, ends].sum(axis=2)) / 15
        corners = area[:, None] * (pressure + total[:, None]) / 12
    return ends, bubbles, corners


@pytest.mark.parametrize("cut", [None, scattered, thinly_scattered])
@pytest.mark.parametrize("name", ["box", "box in space"])
def test_a_linear_pressure_on_flat_sides_is_carried_exactly(comm, name, cut, monkeypatch):
    """Of a pressure 1 + 20 y along the sides of the box the pairs take ∫ φ p dS, edges ∫ b p dS."""
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    mesh = MESHES[name](comm)
    pairs, shares = rule_of(mesh, True)
    facets = surface_facets(mesh, mesh.bodies["casting"], "mould")
    ends, bubbles, corners = of_facets(facets, 1.0 + 20.0 * facets.points[:, :, 1])
    nodes = mesh.bodies["casting"].nodes.dofmap.index_map.size_global
    edges = np.sort(facets.nodes[:, ends], axis=2).reshape(-1, 2)
    numbers, back = np.unique(edges @ [nodes, 1], return_inverse=True)
    vectors = np.repeat(facets.normals, len(ends), axis=0) * bubbles.reshape(-1, 1)
    expected = np.zeros((len(numbers), vectors.shape[1]))
    np.add.at(expected, back.ravel(), -vectors)

    along = facets.normals[:, None] @ pairs.normals.T < -0.9
    same = facets.nodes[:, :, None] == pairs.secondary_nodes
    force = np.einsum("fc,fcp->p", corners, same & along)
    pressure = (force / pairs.areas)[shares.pair]
    per_share = (shares.areas * pressure)[:, None] * shares.normals
    where = np.searchsorted(numbers, np.sort(shares.ends, axis=1) @ [nodes, 1])
    found = np.zeros_like(expected)
    np.add.at(found, where, per_share)
    np.testing.assert_allclose(comm.allreduce(found), expected, atol=1e-12 * np.abs(expected).max())


def test_ends_share_an_edge_evenly_far_from_the_rim(comm):
    mesh = MESHES["box"](comm)
    pairs, shares = rule_of(mesh, True)
    points = everywhere(comm, pairs.points[shares.pair])
    size = everywhere(comm, shares.areas)
    inside = np.abs(points[:, 0] - points[:, 0].mean()) < 1e-9
    assert np.count_nonzero(inside) == 4
    np.testing.assert_allclose(size[inside], 0.01 / 3)


def test_a_node_that_faces_two_bodies_has_a_part_of_its_edges_in_each(comm, shared_tmp_path):
    """On a base that parts in the middle, below a gap: all edges together have theirs once."""
    x = np.array([*range(5)], dtype=np.float64)
    y = np.array([-2.0, -1.0, 0.0, 0.1, 1.0, 2.0])

    def region(middle):
        below = np.where(middle[:, 1] > 0, -1, np.where(middle[:, 0] < 2, 1, 2))
        return np.where(middle[:, 1] > 0.1, 0, below)

    names, tops = ["upper", "left", "right"], plane("top", 1, 0.0, 1e-9)
    surfaces = [plane("skin", 1, 0.1, 1e-9), tops, everything_else("side")]
    mesh = drawn(
        comm, "plane-strain", names, shared_tmp_path / "bases.msh",
        lambda: fill_model(grid(x, y, region), names, surfaces),
    )  # fmt: skip
    rule = Pairing(kind="node-to-face", surfaces=("skin", "top"))
    total, alone = 0.0, 0
    for pairs in pairs_of(mesh, [Facing("upper", name, rule) for name in names[1:]]):
        shares = edge_shares(facet_pairs(mesh, pairs, None), pairs, mesh.model)
        total += comm.allreduce(float(shares.areas.sum()))
        alone += comm.allreduce(len(pairs.areas))
    assert alone > len(x)
    assert total == pytest.approx(2 / 3 * 4.0)
