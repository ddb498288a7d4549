"""Areas and normals of the nodes of a surface."""

from typing import Any

import ufl


def nodal_area(v: Any, weight: Any, ds: ufl.Measure) -> ufl.Form:
    """Area of a node, ∫ v dS."""
    return weight * v * ds


def nodal_area_vector(v: Any, n: Any, weight: Any, ds: ufl.Measure) -> ufl.Form:
    """Area times mean normal of a node, ∫ v·n dS."""
    return weight * ufl.inner(n, v) * ds
