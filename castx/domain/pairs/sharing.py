"""One owner for each area of a surface that faces several others.

A skin may stand in the interfaces with both halves of a die and with a core. Each facet is divided
among its corners, and each part belongs to the surface that it faces at the least distance; a node
passes its area to its pairs by what belongs to their interfaces, so that the areas of all pairs add
up to that of the skin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from castx.arrays import FloatArray
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.face_pairs import FaceInterface, FacingNodes, facing_nodes
from castx.domain.pairs.facing import SurfacePoints, faced, facet_sizes
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import MeshError

FACING = 0.5
"""Cosine that the opposite of a facet's normal has at least with that of the facet it faces."""

EQUAL = 1e-6
"""Difference of distances, in sizes of a facet, below which a part belongs to several equally."""

Side = tuple[int, int]
"""Number of an interface, and 0 for its secondary or 1 for its primary surface."""


def shared_pairs(mesh: CastingMesh, interfaces: Sequence[FaceInterface]) -> list[NodePairs]:
    """Return the pairs of interfaces from node to face, each area in one of them; collective.

    Args:
        mesh: mesh of the bodies.
        interfaces: all that may share a surface.

    Raises:
        MeshError: nothing faces a surface, or all of it is closer to others; on all ranks.
    """
    nodes = [facing_nodes(mesh, interface) for interface in interfaces]
    owned: dict[Side, FloatArray] = {}
    sides: dict[tuple[str, str], list[Side]] = {}
    for number, interface in enumerate(interfaces):
        for side in (0, 1):
            key = (interface.bodies[side], interface.surfaces[side])
            sides.setdefault(key, []).append((number, side))
    for together in sides.values():
        owned |= _owners(interfaces, together)
    found = []
    for number, facing in enumerate(nodes):
        surface = (facing.interface.bodies[0], facing.interface.surfaces[0])
        primary_area = float(np.sum(facing.interface.facets[1].areas * owned[number, 1]))
        together = sides[surface]
        if len(together) == 1:
            pairs = facing.pairs(facing.areas, facing.outward)
        else:
            pairs = _shared(facing, number, together, nodes, owned)
        if mesh.comm.allreduce(len(pairs.areas)) == 0:
            raise MeshError(
                f"interface {pairs.name}: every part of {'/'.join(surface)} lies closer to another "
                "surface that it faces; name other surfaces, or leave this interface out"
            )
        found.append(replace(pairs, primary_area=primary_area))
    return found


def _owners(
    interfaces: Sequence[FaceInterface], sides: Sequence[Side]
) -> dict[Side, FloatArray]:
    """Return the shares of the parts of a surface for each interface, (facets, corners)."""
    number, side = sides[0]
    facets = interfaces[number].facets[side]
    corners = facets.nodes.shape[1]
    # The middle of each part: half way from the centre of the facet to its corner.
    middle = 0.5 * (facets.points + facets.points.mean(axis=1, keepdims=True))
    sizes = np.repeat(facet_sizes(facets), corners)
    points = SurfacePoints(
        middle.reshape(-1, middle.shape[2]), np.repeat(facets.normals, corners, axis=0), sizes
    )
    distances = np.stack([
        faced(points, interfaces[n].facets[1 - s], interfaces[n].rule.search_distance, FACING)[1]
        for n, s in sides
    ])  # fmt: skip
    least = distances.min(axis=0)
    closest = np.isfinite(distances) & (distances <= least + EQUAL * sizes)
    shares = closest / np.maximum(closest.sum(axis=0), 1)
    return dict(zip(sides, shares.reshape(len(sides), -1, corners), strict=True))


def _shared(
    facing: FacingNodes,
    number: int,
    sides: Sequence[Side],
    nodes: Sequence[FacingNodes],
    owned: dict[Side, FloatArray],
) -> NodePairs:
    """Return the pairs of an interface whose secondary surface stands in others too."""
    facets = facing.interface.facets[0]
    total, standing = np.zeros(len(facing.local)), np.zeros(len(facing.local))
    for n, side in sides:
        # Nodes of other bodies carry the pairs with a surface that is the primary one.
        there = side == 1 or np.isin(facing.local, nodes[n].local)
        total += there * _at_nodes(facing, facets.areas * owned[n, side])
        standing += there
    mine = _at_nodes(facing, facets.areas * owned[number, 0])
    # What faces nothing is divided evenly.
    share = np.divide(mine, total, out=1.0 / standing, where=total > 0)
    vectors = facets.vectors * owned[number, 0][:, :, None]
    own = np.stack([_at_nodes(facing, part) for part in np.moveaxis(vectors, 2, 0)], axis=1)
    length = np.linalg.norm(own, axis=1, keepdims=True)
    clear = length > FACING * mine[:, None]
    outward = np.divide(own, length, out=facing.outward.copy(), where=clear)
    return facing.pairs(share * facing.areas, outward)


def _at_nodes(facing: FacingNodes, parts: FloatArray) -> FloatArray:
    """Return the sums of values of corners at the facing nodes of this rank, shape (nodes,)."""
    low, high = facing.own.nodes.dofmap.index_map.local_range
    nodes = facing.interface.facets[0].nodes
    here = (nodes >= low) & (nodes < high)
    sums = np.bincount(nodes[here] - low, parts[here], high - low)
    return np.asarray(sums[facing.local])
