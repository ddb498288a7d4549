"""Volumes, areas and normals of nodes: the integrals of their shape functions."""

from typing import Any

import ufl


def nodal_measure(v: Any, weight: Any, measure: Any) -> Any:
    """Return ∫ φ: over the cells the volume [m³], over facets the area [m²] of each node.

    Args:
        v: test function φ, scalar.
        weight: 2πr when axisymmetric, else 1.
        measure: of the integral.
    """
    return weight * v * measure


def nodal_area_vector(v: Any, n: Any, weight: Any, ds: ufl.Measure) -> ufl.Form:
    """Return ∫ φ n dS, the area of each node times its mean normal [m²].

    Args:
        v: test function φ, a vector.
        n: outward unit normal.
        weight: 2πr when axisymmetric, else 1.
        ds: measure of the surface.
    """
    return weight * ufl.inner(n, v) * ds
