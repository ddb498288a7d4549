"""How the nodes of an interface find their partners and their normals."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Pairing:
    """The rule by which an interface is paired.

    Attributes:
        normals: "averaged" over the facets round a node, or one for each of the smooth "patches".
        sharp_angle: between the normals of neighbouring facets of different patches [rad].
    """

    normals: str = "averaged"
    sharp_angle: float = math.radians(40.0)


BY_NODES = Pairing()
"""The rule where nothing else is said."""
