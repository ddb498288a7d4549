"""Flow of melt through a mush: Darcy's law in the continuity equation of a step.

Melt moves relative to the skeleton by w = (K/μ)(∇p + b), with p the mean stress, positive in
tension, and b the body force. Over a step Δt the continuity equation gets, with τ_D = Δt K/μ,

    -Σ_e τ_D ∫ ∇q·(∇p + b),

the sign of the stabilisation (`castx.forms.stabilisation`), of which only what exceeds τ_D is left,
τ_x = max(τ_e - τ_D, 0).

Source: H. Darcy, Les fontaines publiques de la ville de Dijon (1856); with the stabilisation of
R. Codina, Computer Methods in Applied Mechanics and Engineering 190 (2000).
"""

from __future__ import annotations

from typing import Any

import ufl


def darcy_flow(p: Any, q: Any, body_force: Any, tau_d: Any, dx: Any) -> Any:
    """Return Σ_e τ_D ∫ ∇q·(∇p + b), what flows towards q in a step [m³ for a unit of q].

    Args:
        p: mean stress of the melt [Pa], positive in tension.
        q: its variation.
        body_force: b [N/m³].
        tau_d: τ_D = Δt K/μ of the cells [m²/Pa].
        dx: weighted measure.
    """
    return tau_d * ufl.inner(ufl.grad(q), ufl.grad(p) + body_force) * dx


def excess(tau_e: Any, tau_d: Any) -> Any:
    """Return τ_x = max(τ_e - τ_D, 0) [m²/Pa]: what flows needs no other stabilisation."""
    return ufl.max_value(tau_e - tau_d, 0.0)

