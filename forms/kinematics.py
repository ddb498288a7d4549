"""Strains and integration weights of every geometric model (Chiumenti, section 2).

Tensors are 3 × 3 in all models. In the plane models the axes are (x, y, z) with z out of the plane,
in the axisymmetric one (r, z, θ).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import ufl


def weight(model: str, x: Any) -> Any:
    """Return the factor of the area element: 2πr when axisymmetric, else 1.

    Args:
        model: geometric model.
        x: position; x[0] is the radius when axisymmetric.
    """
    return 2 * math.pi * x[0] if model == "axisymmetric" else ufl.as_ufl(1.0)


@dataclass(frozen=True)
class WeightedMeasure:
    """A measure that multiplies its integrand by the weight of the model: `f * dx`."""

    weight: Any
    measure: Any

    def __rmul__(self, integrand: Any) -> Any:
        """Return the integral of an integrand."""
        return integrand * self.weight * self.measure

    def __call__(self, tag: int) -> WeightedMeasure:
        """Return the measure of the part with a tag."""
        return WeightedMeasure(self.weight, self.measure(tag))


def strain(u: Any, model: str, x: Any, out_of_plane: Any = 0.0) -> Any:
    """Return the small strain ε = ∇ˢu = (∇u + ∇uᵀ)/2, shape (3, 3), with ε_θθ = u_r/r.

    Args:
        u: displacement [m], shape (3,) in the model "3d", else (2,).
        model: "3d", "axisymmetric", "plane-strain" or "plane-stress".
        x: position; x[0] is the radius when axisymmetric.
        out_of_plane: strain ε_zz of the plane models.
    """
    gradient = ufl.sym(ufl.grad(u))
    if model == "3d":
        return gradient
    normal = u[0] / x[0] if model == "axisymmetric" else out_of_plane
    return ufl.as_tensor(
        (
            (gradient[0, 0], gradient[0, 1], 0),
            (gradient[1, 0], gradient[1, 1], 0),
            (0, 0, normal),
        )
    )


def deviator(tensor: Any) -> Any:
    """Return dev(A) = A - tr(A)/3 1 of a (3, 3) tensor."""
    return tensor - ufl.tr(tensor) / 3 * ufl.Identity(3)


def symmetric_tensor(components: Any, model: str) -> Any:
    """Return the (3, 3) tensor of the components xx, yy, zz, xy and, in 3-D, xz, yz."""
    xx, yy, zz, xy = (components[i] for i in range(4))
    xz, yz = (components[4], components[5]) if model == "3d" else (0, 0)
    return ufl.as_tensor(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))


def symmetric_components(tensor: Any, model: str) -> Any:
    """Return the components of a symmetric (3, 3) tensor in the order of `symmetric_tensor`."""
    plane = [tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1]]
    return ufl.as_vector(plane + ([tensor[0, 2], tensor[1, 2]] if model == "3d" else []))
