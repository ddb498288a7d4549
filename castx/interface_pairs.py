"""Pairs of an interface by its rule."""

from __future__ import annotations

from castx.contact.pairing import Pairing
from castx.interfaces import Interface
from castx.mesh import CastingMesh
from castx.pairs import NodePairs, node_pairs
from castx.patches import pairs_by_patch


def paired(mesh: CastingMesh, interface: Interface) -> NodePairs:
    """Return the pairs of an interface of a case; collective.

    Raises:
        MeshError: the bodies share no surface, or its normals cancel at a node; on all ranks.
    """
    rule = interface.contact.pairing_rule
    return interface_pairs(mesh, interface.secondary, interface.primary, rule)


def interface_pairs(
    mesh: CastingMesh, secondary: str, primary: str, rule: Pairing
) -> NodePairs:
    """Return the pairs of two bodies; collective.

    Raises:
        MeshError: the bodies share no surface, or its normals cancel at a node; on all ranks.
    """
    if rule.normals == "patches":
        return pairs_by_patch(mesh, secondary, primary, rule.sharp_angle)
    return node_pairs(mesh, secondary, primary)
