"""Areas and normals of the nodes of a surface."""

from typing import Any

import ufl


def circumference(mesh: ufl.Mesh, model: str) -> Any:
    """Length that a point of the mesh stands for: 2πr [m] when axisymmetric, else 1."""
    if model == "axisymmetric":
        return 2 * ufl.pi * ufl.SpatialCoordinate(mesh)[0]
    return ufl.as_ufl(1.0)


def nodal_area(v: Any, weight: Any, ds: ufl.Measure) -> ufl.Form:
    """Area of a node, ∫ v dS."""
    return weight * v * ds


def nodal_area_vector(v: Any, n: Any, weight: Any, ds: ufl.Measure) -> ufl.Form:
    """Area times mean normal of a node, ∫ v·n dS."""
    return weight * ufl.inner(n, v) * ds
