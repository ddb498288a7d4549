"""Quasi-static balance of momentum, with and without a pressure field (Chiumenti, 2.2).

The stress is σ = p 1 + s. The constitutive law gives s at the integration points, and how it
changes with the strain: ds = a dev(dε) + b n (n:dε), where n is a unit tensor. Tension is positive.

Strains are (3, 3) tensors of `castx.forms.kinematics`. In plane stress the law also finds ε_zz from
σ_zz = 0; strains of unknowns and variations are then those in the plane.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import ufl

from castx.forms.kinematics import deviator


class PointState(NamedTuple):
    """State of the integration points as the constitutive law gives it to the forms.

    Attributes:
        stress: deviatoric stress s at the integration points [Pa], shape (3, 3).
        isotropic: a of the tangent [Pa], 2 G in an elastic point.
        radial: b of the tangent [Pa]; None in elastic bodies.
        direction: n of the tangent, shape (3, 3).
        compressibility: 1/K in the cells [1/Pa], zero in a liquid.
        thermal_strain: volumetric thermal strain e^θ in the cells.
        out_of_plane: ε_zz of plane stress; None in all other models.
        trapped: one in liquid that cannot be fed, else zero.
        trapped_pressure: pressure of trapped liquid [Pa].
    """

    stress: Any
    isotropic: Any
    radial: Any
    direction: Any
    compressibility: Any
    thermal_strain: Any
    out_of_plane: Any = None
    trapped: Any = 0.0
    trapped_pressure: Any = 0.0


def tangent_stress(increment: Any, state: PointState) -> Any:
    """Return ds = a dev(dε) + b n (n:dε) [Pa], shape (3, 3)."""
    change = state.isotropic * deviator(increment)
    if state.radial is not None:
        n = state.direction
        change += state.radial * ufl.inner(n, increment) * n
    return change


def _normal_tangent(state: PointState) -> Any:
    """Return ds_zz/dε_zz [Pa]."""
    change = 2 * state.isotropic / 3
    if state.radial is not None:
        change += state.radial * state.direction[2, 2] ** 2
    return change


def _with_normal(strain: Any, normal: Any) -> Any:
    return strain + normal * ufl.as_tensor(((0, 0, 0), (0, 0, 0), (0, 0, 1)))


def _total(strain: Any, state: PointState) -> Any:
    return strain if state.out_of_plane is None else _with_normal(strain, state.out_of_plane)


def mixed_internal_virtual_work(
    total: Any, p: Any, variation: Any, q: Any, state: PointState, dx: Any, dx_p: Any
) -> Any:
    """Return ∫ ∇ˢη:s + ∫ p ∇·η + ∫ q (∇·u - p/K - e^θ) (section 2.2, weak form).

    Trapped liquid acts with its given pressure and has (p_trapped - p)/K in place of the last
    factor: its volume is free.

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
    given = state.trapped * state.trapped_pressure
    pressure = ((1 - state.trapped) * p + given) * ufl.tr(variation) * dx_p
    dilatation = (1 - state.trapped) * ufl.tr(_total(total, state)) - state.thermal_strain
    relative_pressure = p - given
    continuity = q * (dilatation - state.compressibility * relative_pressure) * dx_p
    return shear + pressure + continuity


def mixed_tangent(
    increment: Any, dp: Any, variation: Any, q: Any, state: PointState, dx: Any, dx_p: Any
) -> Any:
    """Return the derivative of `mixed_internal_virtual_work` for changes of strain and pressure."""
    if state.out_of_plane is not None:
        stress = tangent_stress(increment, state)
        normal = -(stress[2, 2] + dp) / _normal_tangent(state)
        increment = _with_normal(increment, normal)
    shear = ufl.inner(tangent_stress(increment, state), variation) * dx
    free = 1 - state.trapped
    pressure = free * dp * ufl.tr(variation) * dx_p
    continuity = q * (free * ufl.tr(increment) - state.compressibility * dp) * dx_p
    return shear + pressure + continuity


def mean_stress(total: Any, state: PointState) -> Any:
    """Return K (∇·u - e^θ) [Pa] of a compressible body."""
    return (ufl.tr(_total(total, state)) - state.thermal_strain) / state.compressibility


def displacement_internal_virtual_work(
    total: Any, variation: Any, state: PointState, dx: Any
) -> Any:
    """Return ∫ ∇ˢη:s + ∫ K (∇·u - e^θ) ∇·η."""
    mean = mean_stress(total, state)
    return (ufl.inner(state.stress, variation) + mean * ufl.tr(variation)) * dx


def displacement_tangent(increment: Any, variation: Any, state: PointState, dx: Any) -> Any:
    """Return the derivative of `displacement_internal_virtual_work` for a change of the strain."""
    K = 1 / state.compressibility
    if state.out_of_plane is not None:
        stress = tangent_stress(increment, state)
        normal = -(stress[2, 2] + K * ufl.tr(increment)) / (_normal_tangent(state) + K)
        increment = _with_normal(increment, normal)
    change = ufl.inner(tangent_stress(increment, state), variation)
    return (change + K * ufl.tr(increment) * ufl.tr(variation)) * dx


def deviatoric_virtual_work(variation: Any, state: PointState, dx: Any) -> Any:
    """Return ∫ ∇ˢη:s, the part of Q1/P0 that is integrated at the points."""
    return ufl.inner(state.stress, variation) * dx


def deviatoric_tangent(increment: Any, variation: Any, state: PointState, dx: Any) -> Any:
    """Return the derivative of `deviatoric_virtual_work` for a change of the strain."""
    return ufl.inner(tangent_stress(increment, state), variation) * dx


def dilatation(increment: Any, cell: Any, dx: Any) -> Any:
    """Return ∫ ∇·u over the cells, tested with constants (Nagtegaal, Parks and Rice 1974)."""
    return cell * ufl.tr(increment) * dx


def body_force_work(eta: Any, body_force: Any, dx: Any) -> Any:
    """Return ∫ η·b over the weighted measure dx."""
    return ufl.inner(body_force, eta) * dx


def traction_work(eta: Any, traction: Any, ds: Any) -> Any:
    """Return ∫_Γ η·t̄ over the weighted surface measure ds."""
    return ufl.inner(traction, eta) * ds


def pressure_work(eta: Any, pressure: Any, normal: Any, ds: Any) -> Any:
    """Return the work -∫_Γ p̄ η·n of a pressure that pushes on a surface."""
    return -pressure * ufl.inner(normal, eta) * ds
