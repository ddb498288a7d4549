"""Stabilisation of linear u/p elements: GLS and orthogonal sub-grid scales (Chiumenti, 2.2).

OSGS subtracts from ∇p its projection Π on the nodes. The projection is lumped and weighted with τ:
a plain one lets the pressure gradient of the solid leak into the liquid, whose τ is far larger.
"""

from __future__ import annotations

import math
from typing import Any

import ufl

CONSTANTS = {"osgs": 1.0, "gls": 0.25}
"""The constant c of τ, by stabilisation.

Pressures are smooth from 0.1 on. The error of OSGS hardly depends on c (from 0.1 to 1 that of the
pressure falls by a third); that of GLS grows with c, since linear elements drop ∇·s from the
residual: on manufactured solutions c = 1 doubles the error of the displacement and triples that of
the pressure.
"""


def element_length(mesh: Any, dimension: int) -> Any:
    """Return h_e [m]: the edge of the right-angled simplex that has the volume of the cell."""
    return (math.factorial(dimension) * ufl.CellVolume(mesh)) ** (1.0 / dimension)


def tau(shear_modulus: Any, length: Any, constant: float) -> Any:
    """Return τ_e = c h_e²/(2 G) [m²/Pa], G the current secant shear modulus."""
    return constant * length**2 / (2 * shear_modulus)


def pressure_laplacian(p: Any, q: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ∇q·∇p."""
    return tau_e * ufl.inner(ufl.grad(q), ufl.grad(p)) * dx


def body_force_residual(q: Any, body_force: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ∇q·b, by which GLS stays consistent under a body force."""
    return tau_e * ufl.inner(ufl.grad(q), body_force) * dx


def weighted_gradient(p: Any, omega: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ω·∇p, the right-hand side of the projection."""
    return tau_e * ufl.inner(omega, ufl.grad(p)) * dx


def projection_weight(omega: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ω for a scalar ω: the lumped matrix of the projection."""
    return tau_e * omega * dx
