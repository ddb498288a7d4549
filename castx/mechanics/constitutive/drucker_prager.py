"""Return mapping of Drucker and Prager with a tension cut-off, and its consistent tangent.

The yield surface depends on the mean stress p (`castx.materials.granular`), so that the return
starts from the strain alone, in shear and in volume: with q_tr = √(3/2) ‖s_tr‖ and
p_tr = K (θ − E), where E is the volumetric strain without pressure, thermal and of all past flow,

    cone       Δγ = (q_tr + μ p_tr − k)/(3G + K μ ψ),   q = q_tr − 3G Δγ,   p = p_tr − K ψ Δγ,
    cut-off    p = t,   q = q_tr,
    both       p = t,   q = k − μ t.

The cone flows by its own slope ψ ≤ μ, the cut-off straight on, and where both do so q and p are
given; at the tip, t = k/μ, nothing is left of q. The volumetric flow is Δθ_p = (p_tr − p)/K.

Tangent, with n = s_tr/‖s_tr‖:

    ds = a de + b n (n:de) + c n dθ,   dp = d (n:de) + κ dθ.

Grains that creep to their yield surface in a relaxation time τ keep ω = τ/(τ + Δt) of the trial
stress over a step Δt, after Duvaut and Lions: σ = (1 − ω) σ_returned + ω σ_tr. At a strain rate ε̇
that is an overstress of the size E ε̇ τ.

Sources: E. A. de Souza Neto, D. Perić, D. R. J. Owen, Computational Methods for Plasticity (2008),
section 8.3, return to cone and apex; W. T. Koiter, Quarterly of Applied Mathematics 11 (1953) 350,
flow at the corner of both; J. C. Simo, J. G. Kennedy,
S. Govindjee, International Journal for Numerical Methods in Engineering 26 (1988) 2161, relaxation
to a surface with corners; FLAC3D, Theory and Background, Drucker-Prager model.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.errors import ConvergenceError
from castx.materials.granular import GranularSurface
from castx.mechanics.constitutive.return_mapping import TINY, tensor_norm


class GranularReturn(NamedTuple):
    """State of the points after a step, and its tangent.

    Attributes:
        stress: s [Pa], shape (points, components).
        mean: p [Pa], shape (points,).
        increment: Δγ = (q_tr − q)/(3G), equivalent of the flow in shear, shape (points,).
        dilatation: Δθ_p, shape (points,).
        direction: n, shape (points, components); 0 where s_tr = 0.
        isotropic: a [Pa], shape (points,).
        radial: b [Pa], shape (points,).
        stress_by_volume: c [Pa], shape (points,).
        mean_by_shear: d [Pa], shape (points,).
        bulk: κ [Pa], shape (points,).
    """

    stress: FloatArray
    mean: FloatArray
    increment: FloatArray
    dilatation: FloatArray
    direction: FloatArray
    isotropic: FloatArray
    radial: FloatArray
    stress_by_volume: FloatArray
    mean_by_shear: FloatArray
    bulk: FloatArray


def return_to_cone(
    trial: FloatArray,
    mean: FloatArray,
    shear_modulus: FloatArray,
    bulk_modulus: FloatArray,
    surface: GranularSurface,
) -> GranularReturn:
    """Return stress, flow and tangent after a step.

    Args:
        trial: s_tr, deviatoric stress if nothing flowed in the step [Pa], (points, components).
        mean: p_tr, likewise [Pa], shape (points,).
        shear_modulus: G [Pa], shape (points,).
        bulk_modulus: K [Pa], shape (points,).
        surface: yield surface at the end of the step.

    Raises:
        ConvergenceError: a strain is not finite; on its own rank alone.
    """
    G, K, mu, psi = shear_modulus, bulk_modulus, surface.friction, surface.dilatancy
    k, t = surface.strength, surface.cut_off
    norm = tensor_norm(trial)
    direction = trial / np.maximum(norm, TINY)[:, None]
    q_tr = np.sqrt(1.5) * norm
    excess = q_tr + mu * mean - k
    _check(excess)
    stiffness = 3 * G + K * mu * psi
    cone, cut, both = _regions(excess, q_tr, mean, surface, K * psi / stiffness)
    corner = np.maximum(k - mu * np.where(both, t, 0.0), 0.0)
    q = np.where(cone, q_tr - 3 * G * excess / stiffness, np.where(both, corner, q_tr))
    p = np.where(cone, mean - K * psi * excess / stiffness, np.where(cut | both, t, mean))
    ratio = np.divide(q, q_tr, out=np.ones_like(q), where=q_tr > 0)
    by_rate = np.where(cone, 6 * G**2 / stiffness, 0.0)
    coupling = np.where(cone, np.sqrt(6.0) * G * K / stiffness, 0.0)
    # On the cone q follows q_tr, at the corner it is given, else it is q_tr.
    return GranularReturn(
        stress=ratio[:, None] * trial,
        mean=p,
        increment=(q_tr - q) / (3 * G),
        dilatation=(mean - p) / K,
        direction=direction,
        isotropic=2 * G * ratio,
        radial=2 * G * (1 - ratio) - by_rate - np.where(both, 2 * G, 0.0),
        stress_by_volume=-mu * coupling,
        mean_by_shear=-psi * coupling,
        bulk=np.where(cut | both, 0.0, K - np.where(cone, K**2 * mu * psi / stiffness, 0.0)),
    )


def relaxed(
    returned: GranularReturn,
    trial: FloatArray,
    mean: FloatArray,
    shear_modulus: FloatArray,
    bulk_modulus: FloatArray,
    share: float,
) -> GranularReturn:
    """Return the state after a step that keeps a share of the trial stress, (1 − ω) σ + ω σ_tr.

    Args:
        returned: state on the yield surface or below it.
        trial: s_tr [Pa], shape (points, components).
        mean: p_tr [Pa], shape (points,).
        shear_modulus: G [Pa], shape (points,).
        bulk_modulus: K [Pa], shape (points,).
        share: ω, 0: the state itself.
    """
    rest = 1 - share
    return GranularReturn(
        rest * returned.stress + share * trial,
        rest * returned.mean + share * mean,
        rest * returned.increment,
        rest * returned.dilatation,
        returned.direction,
        rest * returned.isotropic + share * 2 * shear_modulus,
        rest * returned.radial,
        rest * returned.stress_by_volume,
        rest * returned.mean_by_shear,
        rest * returned.bulk + share * bulk_modulus,
    )


def _regions(
    excess: FloatArray,
    q_tr: FloatArray,
    mean: FloatArray,
    surface: GranularSurface,
    lowering: FloatArray,
) -> tuple[BoolArray, BoolArray, BoolArray]:
    """Return the points on the cone, at the cut-off, and at the corner of both.

    Args:
        excess: q_tr + μ p_tr − k [Pa], shape (points,).
        q_tr: [Pa], shape (points,).
        mean: p_tr [Pa], shape (points,).
        surface: yield surface.
        lowering: of the mean stress by a return to the cone, over `excess`, shape (points,).
    """
    sheared, t = excess > 0, surface.cut_off
    cone = sheared & (mean - lowering * excess <= t)
    torn = ~cone & (mean > t)
    at_cut = np.where(torn, t, 0.0)
    cut = torn & (q_tr + surface.friction * at_cut <= surface.strength)
    return cone, cut, torn & ~cut


def _check(excess: FloatArray) -> None:
    failed = np.flatnonzero(~np.isfinite(excess))
    if failed.size:
        raise ConvergenceError(
            f"return mapping: strain or property is not finite at {failed.size} of {len(excess)} "
            f"points, first at point {failed[0]}; the step must be smaller"
        )
