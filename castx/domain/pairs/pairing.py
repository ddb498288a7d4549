"""Pairs of an interface by the rule of its case."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.case.contact import Pairing
from castx.case.interfaces import Interface
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.face_pairs import face_pairs
from castx.domain.pairs.node_pairs import NodePairs, node_pairs
from castx.domain.pairs.patches import pairs_by_patch


def paired(mesh: CastingMesh, interface: Interface) -> NodePairs:
    """Return the pairs of an interface of a case; collective.

    Raises:
        MeshError: the bodies share no surface, or its normals cancel at a node; on all ranks.
    """
    rule = interface.contact.pairing_rule
    return interface_pairs(mesh, interface.secondary, interface.primary, rule)


def initial_gap(interface: Interface, pairs: NodePairs) -> FloatArray:
    """Return the gaps of pairs without displacements, the meshed ones and those of the case [m]."""
    return np.asarray(pairs.gap + interface.contact.initial_gap.at(pairs.points))


def interface_pairs(
    mesh: CastingMesh, secondary: str, primary: str, rule: Pairing
) -> NodePairs:
    """Return the pairs of two bodies by a rule; collective.

    Args:
        mesh: mesh of the bodies.
        secondary: name of the body whose nodes carry the pairs.
        primary: name of the other body.
        rule: how nodes find partners and normals.

    Raises:
        MeshError: the bodies share no surface, its normals cancel at a node, or nothing faces the
            other surface; on all ranks.
    """
    if rule.kind == "node-to-face":
        return face_pairs(mesh, secondary, primary, rule)
    if rule.normals == "patches":
        return pairs_by_patch(mesh, secondary, primary, rule.sharp_angle)
    # Matching surfaces have the same facets on both sides, and so the same normals.
    return node_pairs(mesh, secondary, primary)
