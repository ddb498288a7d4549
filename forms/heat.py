"""Weak form of the enthalpy equation (Chiumenti, section 2.3).

Storage, surfaces and node pairs are integrated at the nodes, so conduction is the only integral
left beside the volumes and areas of the nodes. It is written in the potential θ = ∫k dT of
Kirchhoff, in which it is linear: k∇T = ∇θ.
"""

from __future__ import annotations

from typing import Any

import ufl


def conduction(potential: Any, v: Any, circumference: Any, dx: Any) -> Any:
    """Return ∫ ∇θ·∇v, the heat that leaves the nodes by conduction [W].

    Source: G. Kirchhoff, Vorlesungen über die Theorie der Wärme (1894); for melting, C. M. Elliott
    and J. R. Ockendon, Weak and Variational Methods for Moving Boundary Problems (1982).

    Args:
        potential: θ [W/m].
        v: test function.
        circumference: 2πr when axisymmetric, else 1.
        dx: measure of the cells.
    """
    return circumference * ufl.inner(ufl.grad(potential), ufl.grad(v)) * dx
