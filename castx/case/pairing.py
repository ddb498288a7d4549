"""How the nodes of an interface find their partners and their normals."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Pairing:
    """The rule by which an interface is paired.

    Attributes:
        normals: "averaged" over the facets round a node, or one for each of the smooth "patches";
            from node to face the mean of both sides, or that of the "primary" facet.
        sharp_angle: between the normals of neighbouring facets of different patches [rad].
        kind: "node-to-node" for matching meshes, "node-to-face" for others.
        surfaces: from node to face those of the secondary and primary body; None: the shared one.
        meshed_gap: whether the distance of the meshes counts, from node to face.
    """

    normals: str = "averaged"
    sharp_angle: float = math.radians(40.0)
    kind: str = "node-to-node"
    surfaces: tuple[str, str] | None = None
    meshed_gap: bool = True


BY_NODES = Pairing()
"""The rule where nothing else is said."""
