"""Shares of the mid-sides of quadratic bodies in the gaps of an interface.

The displacement of a quadratic body is linear between its nodes and has a bubble w at each
mid-side beside that. Only nodes have pairs; the gap of a pair counts the bubbles round its node,

    g = g0 + n·(u_secondary − u_primary) + Σ_e m_e·(w_secondary − w_primary)/S,

with m_e its part of the area vector ∫ b n dS of an edge (`castx.domain.pairs.edge_shares`, of the
body that is faced from node to face `castx.domain.pairs.facing_edges`) and S the area of the pair.
It is the mean gap round the node, and its force p S acts on the bubbles with p m_e, as a uniform
pressure does: edges touch in the mean.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray, IntArray, LongArray
from castx.case.contact import BY_NODES, Pairing
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.edge_shares import edge_shares
from castx.domain.pairs.facet_pairs import FacetPairs, facet_pairs
from castx.domain.pairs.facing_edges import FacingEdges, facing_edges
from castx.domain.pairs.node_pairs import NodePairs
from castx.mechanics.midsides.midsides import Midsides


@dataclass(frozen=True)
class MidsideShares:
    """Shares of the mid-sides of one body in the pairs of an interface on this rank.

    Attributes:
        body: name of the body.
        sign: 1 of the secondary body, -1 of the primary one.
        pair: numbers of pairs, shape (n,).
        midsides: global numbers of mid-sides, of any owner, shape (n,).
        areas: of their parts m_e of the area vectors, negative where these point backwards [m²],
            shape (n,).
        normals: unit vectors along the area vectors of the edges, shape (n, dimension).
    """

    body: str
    sign: float
    pair: IntArray
    midsides: LongArray
    areas: FloatArray
    normals: FloatArray

    @property
    def name(self) -> str:
        """Name of the mid-sides in the layout of all unknowns."""
        return name_of_midsides(self.body)


def name_of_midsides(body: str) -> str:
    """Return the name of the mid-sides of a body in the layout of all unknowns."""
    return f"mid-sides of {body}"


class QuadraticPairs(NamedTuple):
    """The pairs of an interface, with mid-sides.

    Attributes:
        nodes: pairs of nodes.
        shares: of mid-sides in these pairs.
        tied: pairs of the mid-sides themselves, with nothing where those of a body stay between
            the ends of their edges.
        facets: round the pairs of nodes; None: nothing has asked for them.
    """

    nodes: NodePairs
    shares: tuple[MidsideShares, ...] = ()
    tied: tuple[NodePairs, ...] = ()
    facets: FacetPairs | None = None


def quadratic_pairs(
    mesh: CastingMesh,
    pairs: NodePairs,
    rule: Pairing,
    tied: bool,
    midsides: Mapping[str, Midsides],
) -> QuadraticPairs:
    """Return pairs of an interface with the mid-sides of its bodies; collective.

    Two quadratic bodies that are tied move as one: their mid-sides are tied too. Where one of them
    is linear or rigid the edges of the other stay straight, and so do those of both where their
    meshes do not match.

    Args:
        mesh: mesh of the bodies.
        pairs: of the interface.
        rule: of these pairs.
        tied: whether the bodies are.
        midsides: of the quadratic bodies by name.
    """
    quadratic = [name for name in (pairs.secondary, pairs.primary) if name in midsides]
    if not quadratic:
        return QuadraticPairs(pairs)
    if tied and pairs.faces is None:
        return QuadraticPairs(pairs, tied=(_tied_midsides(mesh, pairs, quadratic, midsides),))
    facets, faced = facet_pairs(mesh, pairs, rule.angle_of_patches), None
    if pairs.faces is not None and pairs.primary in midsides:
        faced = facing_edges(mesh, facets, pairs, rule)
    if tied:
        return QuadraticPairs(pairs, tied=tuple(_straight(mesh, pairs, midsides, rule, faced)))
    shares = edge_shares(facets, pairs, mesh.model)
    found = []
    for name in quadratic:
        own, of_body = name == pairs.secondary, shares
        ends = shares.ends if own else _facing(mesh, pairs)[shares.ends]
        if faced is not None and not own:
            of_body, ends = faced.shares, faced.shares.ends
        numbers = midsides[name].at_edges(_surface_of(name, pairs, rule), ends)
        sign = 1.0 if own else -1.0
        found.append(
            MidsideShares(name, sign, of_body.pair, numbers, of_body.areas, of_body.normals)
        )
    return QuadraticPairs(pairs, tuple(found), facets=facets)


def _tied_midsides(
    mesh: CastingMesh,
    pairs: NodePairs,
    quadratic: Sequence[str],
    midsides: Mapping[str, Midsides],
) -> NodePairs:
    """Return pairs of the mid-sides of tied bodies, of one body with nothing else; collective."""
    name = quadratic[0]
    own = midsides[name]
    local = own.on_surface(_surface_of(name, pairs))
    local = local[local < own.owned_midsides]
    if len(quadratic) == 1:
        return _with_nothing(mesh, name, own, local)
    nodes = mesh.bodies[name].nodes.dofmap.index_map
    ends = nodes.local_to_global(own.ends[local].ravel()).reshape(-1, 2)
    there = _surface_of(quadratic[1], pairs)
    facing = midsides[quadratic[1]].at_edges(there, _facing(mesh, pairs)[ends])
    found = _with_nothing(mesh, name, own, local)
    return replace(found, primary=name_of_midsides(quadratic[1]), primary_nodes=facing)


def _straight(
    mesh: CastingMesh,
    pairs: NodePairs,
    midsides: Mapping[str, Midsides],
    rule: Pairing,
    faced: FacingEdges | None,
) -> Iterator[NodePairs]:
    """Yield pairs of the mid-sides of each body with nothing, tied from node to face; collective.

    Args:
        mesh: mesh of the bodies.
        pairs: of the interface.
        midsides: of the quadratic bodies by name.
        rule: of the pairs.
        faced: edges of the primary body; None: it is linear.
    """
    if pairs.secondary in midsides:
        own = midsides[pairs.secondary]
        local = own.on_surface(_surface_of(pairs.secondary, pairs, rule))
        yield _with_nothing(mesh, pairs.secondary, own, local[local < own.owned_midsides])
    if faced is not None:
        own = midsides[pairs.primary]
        surface = _surface_of(pairs.primary, pairs, rule)
        first, end = own.space.dofmap.index_map.local_range
        numbers = own.at_edges(surface, faced.touching)
        local = (numbers[(numbers >= first) & (numbers < end)] - first).astype(np.int32)
        yield _with_nothing(mesh, pairs.primary, own, local)


def _with_nothing(mesh: CastingMesh, body: str, own: Midsides, local: IntArray) -> NodePairs:
    """Return pairs of mid-sides of a body, by their local numbers, that face nothing."""
    points = mesh.bodies[body].points[own.ends[local]].mean(axis=1)
    none = np.zeros_like(points)
    return NodePairs(
        name_of_midsides(body), "", own.space.dofmap.index_map.local_to_global(local), local,
        np.zeros(len(local), dtype=np.int64), own.numbering.numbers[local], points,
        np.ones(len(local)), none, none,
    )  # fmt: skip


def _surface_of(body: str, pairs: NodePairs, rule: Pairing = BY_NODES) -> str:
    """Return the surface of a body in an interface, which from node to face may have a name."""
    if body == pairs.secondary:
        return pairs.surface
    return rule.surfaces[1] if rule.surfaces else pairs.secondary


def _facing(mesh: CastingMesh, pairs: NodePairs) -> LongArray:
    """Return the primary node of each secondary node, -1 where it has none; collective."""
    nodes = mesh.bodies[pairs.secondary].nodes.dofmap.index_map.size_global
    found = np.full(nodes, -1, dtype=np.int64)
    for own, facing in mesh.comm.allgather((pairs.secondary_nodes, pairs.primary_nodes)):
        found[own] = facing
    return found
