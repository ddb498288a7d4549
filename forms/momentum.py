"""Quasi-static balance of momentum, with and without a pressure field (Chiumenti, section 2.2).

The strong form is ∇·s + ∇p + b = 0 with σ = p 1 + s, its mixed weak form for all η and q

    ∫ ∇ˢη:s + ∫ p ∇·η = ∫ η·b + ∫_Γ η·t̄ + contact,
    ∫ q (∇·u - p/K - e^θ) = 0.

Tension is positive; the paper prints +p/K, which holds for a pressure that is positive in
compression. The constitutive law gives s at the integration points and its change with the strain,
ds = a dev(dε) + b n (n:dε), where n is a unit tensor.

Strains are (3, 3) tensors of `castx.forms.kinematics`. In plane stress the law also finds ε_zz from
σ_zz = 0; strains of unknowns and variations are then those in the plane.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import ufl

from castx.forms.kinematics import deviator


class PlasticVolume(NamedTuple):
    """Volume of grains that flow, and its tangent, ds = ... + c n dθ and dp = d n:de + κ dθ.

    Attributes:
        dilatation: Δθ_p, volumetric flow of the step.
        stress_by_volume: c [Pa].
        mean_by_shear: d [Pa].
        bulk: κ [Pa], K in an elastic point.
    """

    dilatation: Any
    stress_by_volume: Any
    mean_by_shear: Any
    bulk: Any


class PointState(NamedTuple):
    """Stress, tangent and volume of a body as the constitutive law gives them to the forms.

    Attributes:
        stress: deviatoric stress s at the integration points [Pa], shape (3, 3).
        isotropic: a of the tangent [Pa], 2 G in an elastic point.
        radial: b of the tangent [Pa]; None in elastic bodies.
        direction: n of the tangent, shape (3, 3).
        compressibility: 1/K in the cells [1/Pa], zero in a liquid.
        thermal_strain: volumetric thermal strain e^θ in the cells.
        out_of_plane: ε_zz of plane stress; None in all other models.
        follows: χ of plane stress, one where ε_zz follows from σ_zz = 0, zero where it is held.
        trapped: one in trapped liquid, which cannot be fed, else zero.
        trapped_pressure: pressure with which it acts [Pa], that of its whole pocket.
        plastic_volume: of grains; None: what flows keeps its volume.
        beside: b and n of mush beside solid in the same points; None: there is none.
    """

    stress: Any
    isotropic: Any
    radial: Any
    direction: Any
    compressibility: Any
    thermal_strain: Any
    out_of_plane: Any = None
    follows: Any = 1.0
    trapped: Any = 0.0
    trapped_pressure: Any = 0.0
    plastic_volume: PlasticVolume | None = None
    beside: tuple[Any, Any] | None = None

    @property
    def radials(self) -> list[tuple[Any, Any]]:
        """All b and n of the tangent."""
        own = [] if self.radial is None else [(self.radial, self.direction)]
        return own if self.beside is None else [*own, self.beside]


def tangent_stress(increment: Any, state: PointState) -> Any:
    """Return ds = a dev(dε) + b n (n:dε) + c n ∇·du [Pa], shape (3, 3); c in grains alone.

    Mush beside solid has b and n of its own.

    The consistent tangent of the radial return: J. C. Simo and T. J. R. Hughes, Computational
    Inelasticity (1998), section 3.3.2.

    Args:
        increment: dε, shape (3, 3).
        state: a, b and n of the integration points.
    """
    change = state.isotropic * deviator(increment)
    for radial, n in state.radials:
        change += radial * ufl.inner(n, increment) * n
    if state.plastic_volume is not None:
        change += state.plastic_volume.stress_by_volume * ufl.tr(increment) * state.direction
    return change


def tangent_mean(increment: Any, state: PointState) -> Any:
    """Return dp = d n:dε + κ ∇·du [Pa] of a compressible body; κ = K and d = 0 but in grains.

    Args:
        increment: dε, shape (3, 3).
        state: of the integration points.
    """
    flowed = state.plastic_volume
    if flowed is None:
        return ufl.tr(increment) / state.compressibility
    shear = flowed.mean_by_shear * ufl.inner(state.direction, increment)
    return shear + flowed.bulk * ufl.tr(increment)


def _normal_tangent(state: PointState) -> Any:
    """Return ds_zz/dε_zz [Pa]."""
    change = 2 * state.isotropic / 3
    for radial, n in state.radials:
        change += radial * n[2, 2] ** 2
    return change


def _with_normal(strain: Any, normal: Any) -> Any:
    return strain + normal * ufl.as_tensor(((0, 0, 0), (0, 0, 0), (0, 0, 1)))


def _total(strain: Any, state: PointState) -> Any:
    return strain if state.out_of_plane is None else _with_normal(strain, state.out_of_plane)


def mixed_internal_virtual_work(
    total: Any, p: Any, variation: Any, q: Any, state: PointState, dx: Any, dx_p: Any
) -> Any:
    """Return ∫ ∇ˢη:s + ∫ p ∇·η + ∫ q (∇·u - p/K - e^θ), the mixed weak form of section 2.2.

    Trapped liquid acts with p_trapped and has (p_trapped - p)/K as the last factor: its cells have
    any volume, and that of the whole pocket sets p_trapped (`castx.mechanics.trapped_liquid`).

    Args:
        total: strain ε(u).
        p: pressure, the mean stress [Pa].
        variation: strain ε(η).
        q: variation of the pressure.
        state: state of the integration points.
        dx: weighted measure of the terms with s.
        dx_p: weighted measure of the terms with p or q, exact for linear p.
    """
    shear = ufl.inner(state.stress, variation) * dx
    free, given = 1 - state.trapped, state.trapped * state.trapped_pressure
    pressure = (free * p + given) * ufl.tr(variation) * dx_p
    dilatation = free * (ufl.tr(_total(total, state)) - state.thermal_strain)
    relative_pressure = p - given
    continuity = q * (dilatation - state.compressibility * relative_pressure) * dx_p
    return shear + pressure + continuity


def mixed_tangent(
    increment: Any, dp: Any, variation: Any, q: Any, state: PointState, dx: Any, dx_p: Any
) -> Any:
    """Return ∫ ∇ˢη:ds + ∫ dp ∇·η + ∫ q (∇·du - dp/K).

    This is the derivative of `mixed_internal_virtual_work`. In plane stress dε_zz is eliminated by
    ds_zz + dp = 0, and zero in the melt.

    Args:
        increment: strain ε(du).
        dp: change of the pressure [Pa].
        variation: strain ε(η).
        q: variation of the pressure.
        state: state of the integration points.
        dx: weighted measure of the terms with s.
        dx_p: weighted measure of the terms with p or q, exact for linear p.
    """
    if state.out_of_plane is not None:
        stress = tangent_stress(increment, state)
        normal = -state.follows * (stress[2, 2] + dp) / _normal_tangent(state)
        increment = _with_normal(increment, normal)
    shear = ufl.inner(tangent_stress(increment, state), variation) * dx
    free = 1 - state.trapped
    pressure = free * dp * ufl.tr(variation) * dx_p
    continuity = q * (free * ufl.tr(increment) - state.compressibility * dp) * dx_p
    return shear + pressure + continuity


def pocket_pressure_work(variation: Any, q: Any, state: PointState, dx_p: Any) -> Any:
    """Return ∫ ∇·η + ∫ q/K over trapped liquid, the derivative of its part for a unit of p_trapped.

    Args:
        variation: strain ε(η).
        q: variation of the pressure, or zero.
        state: state of the integration points.
        dx_p: weighted measure of the terms with p or q, exact for linear p.
    """
    return state.trapped * (ufl.tr(variation) + state.compressibility * q) * dx_p


def mean_stress(total: Any, state: PointState) -> Any:
    """Return p = K (∇·u - e^θ - Δθ_p) [Pa] of a compressible body, from the continuity equation."""
    if state.plastic_volume is not None:
        free = state.thermal_strain + state.plastic_volume.dilatation
        state = state._replace(thermal_strain=free)
    return (ufl.tr(_total(total, state)) - state.thermal_strain) / state.compressibility


def displacement_internal_virtual_work(
    total: Any, variation: Any, state: PointState, dx: Any
) -> Any:
    """Return ∫ ∇ˢη:s + ∫ K (∇·u - e^θ) ∇·η, the weak form of section 2.2 without its pressure.

    Args:
        total: strain ε(u).
        variation: strain ε(η).
        state: state of the integration points, compressible.
        dx: weighted measure.
    """
    mean = mean_stress(total, state)
    return (ufl.inner(state.stress, variation) + mean * ufl.tr(variation)) * dx


def displacement_tangent(increment: Any, variation: Any, state: PointState, dx: Any) -> Any:
    """Return ∫ ∇ˢη:ds + ∫ dp ∇·η, with dp = K ∇·du but in grains.

    This is the derivative of `displacement_internal_virtual_work`. In plane stress dε_zz is
    eliminated by ds_zz + K ∇·du = 0.

    Args:
        increment: strain ε(du).
        variation: strain ε(η).
        state: state of the integration points, compressible.
        dx: weighted measure.
    """
    if state.out_of_plane is not None:
        K = 1 / state.compressibility
        stress = tangent_stress(increment, state)
        normal = -(stress[2, 2] + K * ufl.tr(increment)) / (_normal_tangent(state) + K)
        increment = _with_normal(increment, normal)
    change = ufl.inner(tangent_stress(increment, state), variation)
    return (change + tangent_mean(increment, state) * ufl.tr(variation)) * dx


def held_strain_work(variation: Any, change: Any, stiffness: Any, dx: Any) -> Any:
    """Return ∫ κ δe (e - e_n), which holds the strain e out of the plane where nothing is solid.

    Args:
        variation: δe.
        change: e - e_n, or its derivative.
        stiffness: κ [Pa].
        dx: weighted measure.
    """
    return stiffness * variation * change * dx


def deviatoric_virtual_work(variation: Any, state: PointState, dx: Any) -> Any:
    """Return ∫ ∇ˢη:s, the part of the weak form of section 2.2 that Q1/P0 takes at the points."""
    return ufl.inner(state.stress, variation) * dx


def deviatoric_tangent(increment: Any, variation: Any, state: PointState, dx: Any) -> Any:
    """Return ∫ ∇ˢη:ds, the derivative of `deviatoric_virtual_work` for a change of the strain."""
    return ufl.inner(tangent_stress(increment, state), variation) * dx


def dilatation(increment: Any, cell: Any, dx: Any) -> Any:
    """Return ∫ ∇·u of each cell, the mean dilatation of Q1/P0 times its volume [m³].

    Source: J. C. Nagtegaal, D. M. Parks and J. R. Rice, Computer Methods in Applied Mechanics and
    Engineering 4 (1974).

    Args:
        increment: strain ε(u).
        cell: test function, constant in each cell.
        dx: weighted measure.
    """
    return cell * ufl.tr(increment) * dx


def body_force_work(eta: Any, body_force: Any, dx: Any) -> Any:
    """Return ∫ η·b, the work of a force per volume b [N/m³] (section 2.2, right-hand side)."""
    return ufl.inner(body_force, eta) * dx


def traction_work(eta: Any, traction: Any, ds: Any) -> Any:
    """Return ∫_Γ η·t̄, the work of a traction t̄ = σ·n [Pa] (section 2.2, right-hand side)."""
    return ufl.inner(traction, eta) * ds


def pressure_work(eta: Any, pressure: Any, normal: Any, ds: Any) -> Any:
    """Return -∫_Γ p̄ η·n, the work of a pressure p̄ [Pa] that pushes on a surface: t̄ = -p̄ n."""
    return -pressure * ufl.inner(normal, eta) * ds
