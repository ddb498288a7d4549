"""Quasi-static balance of momentum, with and without a pressure field (Chiumenti, 2.2).

The stress is σ = p 1 + s with s = 2 G (dev ε - e0): G is the secant shear modulus of the step and
e0 the deviatoric strain at which the material is free of deviatoric stress. Tension is positive.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import ufl

from castx.forms.kinematics import deviator, strain


class ElasticState(NamedTuple):
    """What the constitutive law hands to the forms, constant in each cell.

    Attributes:
        shear_modulus: secant shear modulus G [Pa].
        compressibility: 1/K [1/Pa], zero in a liquid.
        thermal_strain: volumetric thermal strain e^θ.
        reference_strain: deviatoric strain e0 without deviatoric stress, shape (3, 3).
        trapped: one in liquid that cannot be fed, else zero.
        trapped_pressure: pressure of trapped liquid [Pa].
    """

    shear_modulus: Any
    compressibility: Any
    thermal_strain: Any
    reference_strain: Any
    trapped: Any = 0.0
    trapped_pressure: Any = 0.0


def mixed_strain(u: Any, p: Any, state: ElasticState, model: str, x: Any) -> Any:
    """Return the strain of the mixed formulation; plane stress eliminates ε_zz from s_zz + p = 0.

    For the variation of the strain pass the test functions and a state whose reference strain is
    zero.
    """
    if model != "plane-stress":
        return strain(u, model, x)
    in_plane = ufl.div(u)
    normal = (
        in_plane / 2 - 3 * p / (4 * state.shear_modulus) + 1.5 * state.reference_strain[2, 2]
    )
    return strain(u, model, x, normal)


def deviatoric_stress(total_strain: Any, state: ElasticState) -> Any:
    """Return s = 2 G (dev ε - e0) [Pa], shape (3, 3)."""
    return 2 * state.shear_modulus * (deviator(total_strain) - state.reference_strain)


def mixed_internal_virtual_work(
    u: Any, p: Any, eta: Any, q: Any, state: ElasticState, model: str, x: Any, dx: Any, dx_p: Any
) -> Any:
    """Return ∫ ∇ˢη:s + ∫ p ∇·η + ∫ q (∇·u - p/K - e^θ) (section 2.2, weak form).

    Trapped liquid acts with its given pressure and has (p_trapped - p)/K in place of the last
    factor: its volume is free.

    Args:
        u: displacement [m].
        p: pressure, the mean stress [Pa].
        eta: variation of the displacement.
        q: variation of the pressure.
        state: elastic state of the cells.
        model: geometric model.
        x: position.
        dx: weighted measure of the deviatoric terms, one point in each cell.
        dx_p: weighted measure of the terms with p or q, exact for linear p.
    """
    free = state._replace(reference_strain=ufl.zero(3, 3))
    total = mixed_strain(u, p, state, model, x)
    variation = mixed_strain(eta, q, free, model, x)
    shear = ufl.inner(deviatoric_stress(total, state), deviator(variation)) * dx
    given = state.trapped * state.trapped_pressure
    pressure = ((1 - state.trapped) * p + given) * ufl.tr(variation) * dx_p
    dilatation = (1 - state.trapped) * ufl.tr(total) - state.thermal_strain
    relative_pressure = p - given
    continuity = q * (dilatation - state.compressibility * relative_pressure) * dx_p
    return shear + pressure + continuity


def displacement_stress(u: Any, state: ElasticState, model: str, x: Any) -> Any:
    """Return σ = K (∇·u - e^θ) 1 + s [Pa], shape (3, 3), with σ_zz = 0 in plane stress."""
    K, G = 1 / state.compressibility, state.shear_modulus
    normal = 0.0
    if model == "plane-stress":
        in_plane = ufl.div(u)
        reference = 2 * G * state.reference_strain[2, 2]
        normal = (K * state.thermal_strain - (K - 2 * G / 3) * in_plane + reference) / (
            K + 4 * G / 3
        )
    total = strain(u, model, x, normal)
    mean = K * (ufl.tr(total) - state.thermal_strain)
    return mean * ufl.Identity(3) + deviatoric_stress(total, state)


def displacement_internal_virtual_work(
    u: Any, eta: Any, state: ElasticState, model: str, x: Any, dx: Any
) -> Any:
    """Return ∫ ∇ˢη:σ(u) over the weighted measure dx, one point in each cell."""
    return ufl.inner(displacement_stress(u, state, model, x), strain(eta, model, x)) * dx


def body_force_work(eta: Any, body_force: Any, dx: Any) -> Any:
    """Return ∫ η·b over the weighted measure dx."""
    return ufl.inner(body_force, eta) * dx


def traction_work(eta: Any, traction: Any, ds: Any) -> Any:
    """Return ∫_Γ η·t̄ over the weighted surface measure ds."""
    return ufl.inner(traction, eta) * ds


def pressure_work(eta: Any, pressure: Any, normal: Any, ds: Any) -> Any:
    """Return the work -∫_Γ p̄ η·n of a pressure that pushes on a surface."""
    return -pressure * ufl.inner(normal, eta) * ds
