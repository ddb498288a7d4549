"""Weak form of the enthalpy equation (Chiumenti, section 2.3).

Storage, surfaces and node pairs are integrated at the nodes, so only two integrals are left: what a
node weighs, and conduction. Conduction is written in the potential θ = ∫k dT of Kirchhoff, in which
it is linear: k∇T = ∇θ.
"""

from __future__ import annotations

from typing import Any

import ufl


def nodal_weight(v: Any, measure: Any) -> Any:
    """Return ∫ v: over the cells the volume, over facets the area that a node stands for.

    Args:
        v: test function.
        measure: of the integral, times 2πr when axisymmetric.
    """
    return v * measure


def conduction(potential: Any, v: Any, dx: Any) -> Any:
    """Return ∫ ∇θ·∇v, the heat that leaves the nodes by conduction [W].

    Source: G. Kirchhoff, Vorlesungen über die Theorie der Wärme (1894); for melting, C. M. Elliott
    and J. R. Ockendon, Weak and Variational Methods for Moving Boundary Problems (1982).

    Args:
        potential: θ [W/m].
        v: test function.
        dx: measure of the cells, times 2πr when axisymmetric.
    """
    return ufl.inner(ufl.grad(potential), ufl.grad(v)) * dx
