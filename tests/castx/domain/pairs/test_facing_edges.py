"""Shares of pairs in the edges that they face: whole areas, whichever mesh is finer."""

from __future__ import annotations

import gmsh
import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.domain.pairs.facet_pairs import facet_pairs
from castx.domain.pairs.facing_edges import facing_edges
from castx.domain.pairs.pairing import Facing, pairs_of
from castx.domain.surface_facets import surface_facets
from tests.elastic_bodies import drawn, everywhere
from tests.partitions import PARTITION, scattered, thinly_scattered

pytestmark = pytest.mark.ranks

NAMES, SURFACES = ("upper", "base"), ("under", "over")
RULE = Pairing(kind="node-to-face", surfaces=SURFACES)
LENGTH, DEPTH, APART = 0.04, 0.03, 1e-6


def draw(space: bool, sizes: tuple[float, float], lengths: tuple[float, float]) -> None:
    """Draw two blocks of cells and lengths of their own, one on the other."""
    geo, parts = gmsh.model.geo, []
    # Apart by so much that gmsh takes no points for one.
    for size, length, low, end in zip(sizes, lengths, (0.0, -APART), (0.01, -0.01), strict=True):
        corners = ((0.0, low), (length, low), (length, end), (0.0, end))
        points = [geo.addPoint(x + 0.01, y, 0.0, size) for x, y in corners]
        lines = [geo.addLine(points[k], points[(k + 1) % 4]) for k in range(4)]
        face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
        whole, sides = face, lines
        if space:
            made = geo.extrude([(2, face)], 0, 0, DEPTH, numElements=[round(DEPTH / size)])
            whole, sides = made[1][1], [tag for _, tag in made[2:]]
        parts.append((whole, sides))
    geo.synchronize()
    d = 3 if space else 2
    for name, surface, (whole, sides) in zip(NAMES, SURFACES, parts, strict=True):
        gmsh.model.addPhysicalGroup(d, [whole], name=name)
        gmsh.model.addPhysicalGroup(d - 1, sides[:1], name=surface)
        gmsh.model.addPhysicalGroup(d - 1, sides[1:], name=f"{name} side")
    gmsh.model.mesh.generate(d)


def shared(comm, folder, model, sizes, lengths=(LENGTH, LENGTH)):
    """Return mesh, pairs and edges of the lower block."""
    mesh = drawn(
        comm, model, NAMES, folder / "blocks.msh", lambda: draw(model == "3d", sizes, lengths)
    )
    (pairs,) = pairs_of(mesh, [Facing(*NAMES, RULE)])
    return mesh, pairs, facing_edges(mesh, facet_pairs(mesh, pairs, None), pairs, RULE)


def bubbles(mesh):
    """Return ends and ∫ b dS of the edges of the lower block, whose facets are even."""
    facets = surface_facets(mesh, mesh.bodies["base"], "over")
    radius = facets.points[:, :, 0] * 2 * np.pi if mesh.model == "axisymmetric" else None
    if mesh.model == "3d":
        ends = facets.nodes[:, facets.kind.faces].reshape(-1, 2)
        area = np.repeat(facets.areas.sum(axis=1) / 3, 3)
    else:
        ends, length = facets.nodes, np.linalg.norm(np.diff(facets.points, axis=1)[:, 0], axis=1)
        area = 2 / 3 * length * (1.0 if radius is None else radius.mean(axis=1))
    numbers, back = np.unique(np.sort(ends, axis=1), axis=0, return_inverse=True)
    return numbers, np.bincount(back.ravel(), area)


@pytest.mark.parametrize("cut", [None, scattered, thinly_scattered])
@pytest.mark.parametrize("sizes", [(0.004, 0.0065), (0.0065, 0.004), (0.003, 0.015)])
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_each_edge_has_its_area_once(comm, shared_tmp_path, model, sizes, cut, monkeypatch):
    """A uniform pressure acts on its bubble as on the surface itself, upwards and nowhere else."""
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    mesh, _, found = shared(comm, shared_tmp_path, model, sizes)
    ends, expected = bubbles(mesh)
    nodes = mesh.bodies["base"].nodes.dofmap.index_map.size_global
    where = np.searchsorted(ends @ [nodes, 1], np.sort(found.shares.ends, axis=1) @ [nodes, 1])
    area = comm.allreduce(np.bincount(where, found.shares.areas, len(ends)))
    np.testing.assert_allclose(area, expected, rtol=1e-12)
    np.testing.assert_array_equal(found.touching, ends)
    up = np.eye(mesh.parent.geometry.dim)[1]
    np.testing.assert_allclose(found.shares.normals, np.tile(up, (len(where), 1)), atol=1e-12)


@pytest.mark.parametrize("sizes", [(0.004, 0.0065), (0.0065, 0.004), (0.003, 0.015)])
def test_nodes_have_what_lies_before_them(comm, shared_tmp_path, sizes):
    """Of the bubbles in front of a line, ∫ b φ dx, by many points between its ends."""
    mesh, pairs, found = shared(comm, shared_tmp_path, "plane-strain", sizes)
    at = np.sort(np.unique(everywhere(comm, pairs.points[:, 0])))
    facets = surface_facets(mesh, mesh.bodies["base"], "over")
    edges = np.sort(facets.points[:, :, 0], axis=1)
    x = 0.01 + LENGTH * (np.arange(200_000) + 0.5) / 200_000
    left, right = edges[np.argmax((edges[:, :1] <= x) & (x < edges[:, 1:]), axis=0)].T
    b = 4 * (x - left) * (right - x) / (right - left) ** 2
    expected = [np.mean(b * np.interp(x, at, row)) * LENGTH for row in np.eye(len(at))]
    place = np.searchsorted(at, pairs.points[found.shares.pair, 0])
    area = comm.allreduce(np.bincount(place, found.shares.areas, len(at)))
    np.testing.assert_allclose(area, expected, rtol=0.06)
    assert area.sum() == pytest.approx(2 / 3 * LENGTH)


def test_what_nothing_faces_has_no_share(comm, shared_tmp_path):
    """A base half as long again: edges behind the end of the upper block do not touch it."""
    lengths = (LENGTH, 1.5 * LENGTH)
    mesh, _, found = shared(comm, shared_tmp_path, "plane-strain", (0.004, 0.005), lengths)
    total = comm.allreduce(found.shares.areas.sum())
    assert total == pytest.approx(2 / 3 * LENGTH, rel=1e-2)
    facets = surface_facets(mesh, mesh.bodies["base"], "over")
    middle = facets.points[:, :, 0].mean(axis=1)
    assert len(found.touching) == np.count_nonzero(middle < 0.01 + LENGTH)
