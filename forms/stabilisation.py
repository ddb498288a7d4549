"""Stabilisation of linear u/p elements: GLS and orthogonal sub-grid scales (Chiumenti, 2.2).

The continuity equation gets the residual of the balance of momentum,

    ∫ q (∇·u - p/K - e^θ) - Σ_e τ_e ∫ ∇q·(∇p - Π) = 0,

with Π = -b in GLS (linear elements have ∇·s = 0) and Σ_e τ_e ∫ ω·(∇p - Π) = 0 for all ω on the
nodes in OSGS. In axisymmetric bodies GLS so drops (s_rr - s_θθ)/r and s_rz/r of ∇·s, an error that
falls with τ, that is with h²; OSGS, which takes Π from the pressure itself, has nothing to drop.
That projection is lumped and weighted with τ_e: a plain one lets the pressure
gradient of the solid leak into the liquid, whose τ_e is far larger. Solid and liquid have one each.
`castx.mechanics.mixed` puts the terms together, `castx.mechanics.osgs` applies the projection.

Sources: T. J. R. Hughes, L. P. Franca and M. Balestra, Computer Methods in Applied Mechanics and
Engineering 59 (1986), for GLS; R. Codina, ibid. 190 (2000), for OSGS.
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
    """Return τ_e = c h_e²/(2 G) [m²/Pa] (section 2.2, which prints h_e c/(2 G)).

    G is the secant shear modulus of the cell at the start of the step, which falls with plastic
    flow, or η/Δt of a Newtonian liquid: `secant_modulus` of `castx.mechanics.constitutive.points`.

    Args:
        shear_modulus: G [Pa].
        length: h_e [m], from `element_length`.
        constant: c, from `CONSTANTS`.
    """
    return constant * length**2 / (2 * shear_modulus)


def pressure_laplacian(p: Any, q: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ∇q·∇p, the stabilising term of GLS (section 2.2)."""
    return tau_e * ufl.inner(ufl.grad(q), ufl.grad(p)) * dx


def body_force_residual(q: Any, body_force: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ∇q·b, which keeps GLS consistent under a body force b [N/m³]."""
    return tau_e * ufl.inner(ufl.grad(q), body_force) * dx


def weighted_gradient(p: Any, omega: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ω·∇p, the right-hand side of the projection of OSGS (section 2.2)."""
    return tau_e * ufl.inner(omega, ufl.grad(p)) * dx


def projection_weight(omega: Any, tau_e: Any, dx: Any) -> Any:
    """Return Σ_e τ_e ∫ ω for a scalar ω, the lumped matrix of the projection of OSGS."""
    return tau_e * omega * dx
