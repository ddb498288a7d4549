"""What the mid-sides of quadratic bodies have in the gaps of an interface.

The displacement of a quadratic body is linear between its nodes and has a bubble w at each
mid-side beside that. Only nodes have pairs; the gap of a pair counts the bubbles round its node,

    g = g0 + n·(u_secondary − u_primary) + Σ_e m_e·(w_secondary − w_primary)/S,

with m_e its part of the area vector ∫ b n dS of an edge (`castx.domain.pairs.edge_shares`) and S
the area of the pair. It is the mean gap round the node, and its force p S acts on the bubbles with
p m_e, as a uniform pressure does. A bubble of one node and its neighbour alone is no gap: edges lie
on the wall in the mean.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, IntArray, LongArray
from castx.case.contact import PATCHES, Pairing
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.edge_shares import edge_shares
from castx.domain.pairs.node_pairs import NodePairs
from castx.mechanics.midsides.midsides import Midsides


@dataclass(frozen=True)
class MidsideShares:
    """What the mid-sides of one body have in the pairs of an interface on this rank.

    Attributes:
        body: name of the body.
        sign: 1 of the secondary body, -1 of the primary one.
        pair: numbers of pairs, shape (n,).
        midsides: global numbers of mid-sides, of any owner, shape (n,).
        vectors: m_e [m²], shape (n, dimension).
    """

    body: str
    sign: float
    pair: IntArray
    midsides: LongArray
    vectors: FloatArray

    @property
    def name(self) -> str:
        """Name of the mid-sides in the layout of all unknowns."""
        return name_of_midsides(self.body)

    def rows_of(self, index: IntArray) -> tuple[IntArray, IntArray]:
        """Return the rows in which the shares count, and the number of the share in each.

        Args:
            index: number of the pair of each row, shape (rows,).
        """
        order = np.argsort(index, kind="stable")
        low, high = (np.searchsorted(index[order], self.pair, side) for side in ("left", "right"))
        count = high - low
        share = np.repeat(np.arange(len(count)), count)
        within = np.arange(len(share)) - np.repeat(np.cumsum(count) - count, count)
        rows = order[low[share] + within]
        return rows.astype(np.int32), share.astype(np.int32)


def name_of_midsides(body: str) -> str:
    """Return the name of the mid-sides of a body in the layout of all unknowns."""
    return f"mid-sides of {body}"


def midside_shares(
    mesh: CastingMesh, pairs: NodePairs, rule: Pairing, midsides: Mapping[str, Midsides]
) -> tuple[MidsideShares, ...]:
    """Return the shares of the mid-sides of both bodies of an interface; collective.

    Args:
        mesh: mesh of the bodies.
        pairs: of the interface.
        rule: of these pairs, which are those of shared nodes if one of the bodies is quadratic.
        midsides: of the quadratic bodies by name.
    """
    quadratic = [name for name in (pairs.secondary, pairs.primary) if name in midsides]
    if not quadratic:
        return ()
    angle = rule.sharp_angle if rule.normals == PATCHES else None
    shares = edge_shares(mesh, pairs, angle)
    found = []
    for name in quadratic:
        own = name == pairs.secondary
        ends = shares.ends if own else _facing(mesh, pairs)[shares.ends]
        surface = pairs.surface if own else pairs.secondary
        numbers = midsides[name].at_edges(surface, ends)
        found.append(MidsideShares(name, 1.0 if own else -1.0, shares.pair, numbers, shares.vectors))
    return tuple(found)


def _facing(mesh: CastingMesh, pairs: NodePairs) -> LongArray:
    """Return the primary node of each secondary node, -1 where it has none; collective."""
    nodes = mesh.bodies[pairs.secondary].nodes.dofmap.index_map.size_global
    found = np.full(nodes, -1, dtype=np.int64)
    for own, facing in mesh.comm.allgather((pairs.secondary_nodes, pairs.primary_nodes)):
        found[own] = facing
    return found
