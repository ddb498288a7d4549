"""Pairs of the interfaces by the rules of their case."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

from castx.arrays import FloatArray
from castx.case.contact import Pairing
from castx.case.interfaces import Interface
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.face_pairs import face_interface
from castx.domain.pairs.node_pairs import NodePairs, node_pairs
from castx.domain.pairs.patches import pairs_by_patch
from castx.domain.pairs.sharing import shared_pairs


class Facing(NamedTuple):
    """Two bodies that face each other.

    Attributes:
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.
        rule: how nodes find partners and normals.
        initial_gap: gap that counts beside the meshed one at points (n, dimension) [m]; None: none.
    """

    secondary: str
    primary: str
    rule: Pairing
    initial_gap: Callable[[FloatArray], FloatArray] | None = None


def case_pairs(
    mesh: CastingMesh, interfaces: Sequence[Interface]
) -> dict[str, NodePairs]:
    """Return the pairs of all interfaces of a case by their names; collective.

    Raises:
        MeshError: as in `pairs_of`.
    """
    facing = [
        Facing(i.secondary, i.primary, i.contact.pairing_rule, i.contact.initial_gap.at)
        for i in interfaces
    ]
    found = pairs_of(mesh, facing)
    return {item.name: pairs for item, pairs in zip(interfaces, found, strict=True)}


def pairs_of(mesh: CastingMesh, facing: Sequence[Facing]) -> list[NodePairs]:
    """Return the pairs of bodies that face each other, each area in one of them; collective.

    Args:
        mesh: mesh of the bodies.
        facing: all bodies that do, and by which rule.

    Raises:
        MeshError: bodies share no surface, its normals cancel at a node, or nothing faces the
            other surface; on all ranks.
    """
    faces = [item for item in facing if item.rule.kind == "node-to-face"]
    by_faces = iter(shared_pairs(mesh, [face_interface(mesh, *item[:3]) for item in faces]))
    return [
        _with_gap(next(by_faces) if item in faces else _matching(mesh, item), item)
        for item in facing
    ]


def _with_gap(pairs: NodePairs, facing: Facing) -> NodePairs:
    given = facing.initial_gap
    return pairs if given is None else replace(pairs, given_gap=given(pairs.points))


def _matching(mesh: CastingMesh, facing: Facing) -> NodePairs:
    secondary, primary, rule, _ = facing
    if rule.normals == "patches":
        return pairs_by_patch(mesh, secondary, primary, rule.sharp_angle)
    # Matching surfaces have the same facets on both sides, and so the same normals.
    return node_pairs(mesh, secondary, primary)
