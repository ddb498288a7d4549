"""Implicit Euler step of J2 viscoplasticity at integration points, and its consistent tangent.

Deviatoric stress s, back stress β, equivalent viscoplastic strain ξ. With the trial stress s_tr =
2G (e − e_vp,n) and q_tr = √(3/2) ‖s_tr − β_n‖ the direction of flow n, that of s_tr − β_n, is known
beforehand, and the increment Δγ of ξ follows from one scalar equation for each point,

    (3G + H_k) Δγ + R(ξ_n + Δγ) − R(ξ_n) + V(Δγ) = q_tr − σ_Y − R(ξ_n),

where the right side, the trial overstress, is positive; else the step is elastic. V is the
overstress that drives the flow through its increment; V = 0 is rate-independent plasticity.

Source of the algorithm, radial return with its consistent tangent: Simo and Hughes, Computational
Inelasticity (1998), chapter 3; of the overstress: Perzyna, Fundamental problems in viscoplasticity,
Advances in Applied Mechanics 9 (1966).

Tensors are arrays of components, shape (points, 4): xx, yy, zz, xy, or (points, 6): xx, yy, zz, xy,
xz, yz; a shear component counts twice in norms and contractions.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray
from castx.errors import ConvergenceError
from castx.materials.flow import FlowProperties, isotropic_hardening

MOST_ITERATIONS = 60
ROUND_OFF = 4 * np.finfo(np.float64).eps
TINY = np.finfo(np.float64).tiny


class Returned(NamedTuple):
    """State of the points after a step.

    The tangent is ds/de = isotropic I_dev + radial n⊗n; of an elastic point 2G and 0.

    Attributes:
        stress: deviatoric stress [Pa], shape (points, components).
        increment: Δγ, shape (points,); 0 where the step is elastic.
        direction: n of norm 1, shape (points, components); 0 where s_tr = β_n.
        isotropic: [Pa], shape (points,).
        radial: [Pa], shape (points,).
    """

    stress: FloatArray
    increment: FloatArray
    direction: FloatArray
    isotropic: FloatArray
    radial: FloatArray


def return_mapping(
    trial: FloatArray, back: FloatArray, equivalent: FloatArray, properties: FlowProperties
) -> Returned:
    """Return stress, flow and tangent after a step (Simo and Hughes 1998, chapter 3).

    The new viscoplastic strain is the old one plus `viscoplastic_strain` of what is returned.

    Args:
        trial: deviatoric stress if nothing flowed in the step [Pa], shape (points, components).
        back: deviatoric back stress of the start of the step [Pa], likewise.
        equivalent: ξ at the start of the step, shape (points,).
        properties: at the end of the step.

    Raises:
        ConvergenceError: a point without solution, on its own rank alone: the caller brings the
            ranks together.
    """
    direction = trial - back
    norm = tensor_norm(direction)
    direction /= np.maximum(norm, TINY)[:, None]
    trial_equivalent = np.sqrt(1.5) * norm
    overstress = trial_equivalent - properties.yield_stress
    overstress -= isotropic_hardening(properties, equivalent)

    increment = np.zeros_like(overstress)
    slope = np.zeros_like(overstress)  # dΔγ/dq_tr
    flowing = np.flatnonzero(~(overstress <= 0.0))  # not a number must not pass for elastic
    if flowing.size:
        there = FlowProperties(*(values[flowing] for values in properties))
        increment[flowing], slope[flowing] = _increment(
            overstress[flowing], equivalent[flowing], there
        )
        _check(increment, slope, overstress)

    shear = properties.shear_modulus
    stress = trial - (np.sqrt(6.0) * shear * increment)[:, None] * direction
    share = 3.0 * shear * increment / np.maximum(trial_equivalent, TINY)
    isotropic = 2.0 * shear * (1.0 - share)
    radial = 2.0 * shear * (share - 3.0 * shear * slope)
    return Returned(stress, increment, direction, isotropic, radial)


def viscoplastic_strain(returned: Returned) -> FloatArray:
    """Return what the step adds to the viscoplastic strain, √(3/2) Δγ n, (points, components)."""
    return np.asarray((np.sqrt(1.5) * returned.increment)[:, None] * returned.direction)


def plastic_work(returned: Returned) -> FloatArray:
    """Return the work s : Δe_vp of the step per volume [J/m³], shape (points,)."""
    along = (returned.stress * returned.direction) @ _weights(returned.stress)
    return np.asarray(np.sqrt(1.5) * returned.increment * along)


def tensor_norm(tensor: FloatArray) -> FloatArray:
    """Return the norm √(t:t) of tensors by components, shape (points,)."""
    return np.asarray(np.sqrt((tensor * tensor) @ _weights(tensor)))


def _weights(tensor: FloatArray) -> FloatArray:
    """Return how often each component counts in a contraction."""
    return np.array([1.0] * 3 + [2.0] * (tensor.shape[1] - 3))


def _check(increment: FloatArray, slope: FloatArray, overstress: FloatArray) -> None:
    """Refuse increments that are not finite; those not found are not a number."""
    failed = np.flatnonzero(~(np.isfinite(increment) & np.isfinite(slope)))
    if failed.size:
        first = failed[0]
        raise ConvergenceError(
            f"return mapping: no increment of flow at {failed.size} of {len(increment)} points, "
            f"first at point {first} with a trial overstress of {overstress[first]:g} Pa; the "
            "step must be smaller, or the strain or a property there is not finite"
        )


def _increment(
    overstress: FloatArray, equivalent: FloatArray, properties: FlowProperties
) -> tuple[FloatArray, FloatArray]:
    """Return Δγ and dΔγ/dq_tr of flowing points, in closed form where the equation is linear."""
    linear = 3.0 * properties.shear_modulus + properties.linear_hardening
    linear += properties.kinematic_hardening
    rate = properties.saturation_rate
    saturation = properties.saturation * np.exp(-rate * equivalent)
    resistance, power = properties.viscous_resistance, properties.viscous_power
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        slope: FloatArray = np.reciprocal(linear + resistance)
        increment = overstress * slope
        curved = (saturation * rate > 0.0) | ((resistance > 0.0) & (power != 1.0))
        if curved.any():
            data = (overstress, linear, saturation, rate, resistance, power)
            equation = _Equation.of(*(values[curved] for values in data))
            increment[curved], slope[curved] = _solve(equation, overstress[curved])
    return increment, slope


class _Equation(NamedTuple):
    """ln(A eʸ + V eᵐʸ + S (1 − exp(−B eʸ))) = 0 for y = ln(Δγ/Δγ_max), one per point.

    Δγ_max is what would flow if of all resistances the strongest of A and V stood alone, so that
    max(A, V) = 1 and y ≤ 0. Without S the left side is convex and its slope lies between 1 and m,
    the power of the viscous overstress: Newton's method cannot fail, however far apart the
    resistances are.
    """

    logarithm: FloatArray  # ln Δγ_max
    linear: FloatArray  # A
    viscous: FloatArray  # V
    power: FloatArray  # m
    saturation: FloatArray  # S
    rate: FloatArray  # B

    @classmethod
    def of(
        cls,
        overstress: FloatArray,
        linear: FloatArray,
        saturation: FloatArray,
        rate: FloatArray,
        resistance: FloatArray,
        power: FloatArray,
    ) -> _Equation:
        """Return the equation scaled by the trial overstress and Δγ_max."""
        log_linear = np.log(linear / overstress)
        log_viscous = np.log(resistance) - np.log(overstress)
        logarithm = np.minimum(-log_linear, -log_viscous / power)
        return cls(
            logarithm,
            np.exp(log_linear + logarithm),
            np.exp(log_viscous + power * logarithm),
            power,
            saturation / overstress,
            rate * np.exp(logarithm),
        )

    def lower_bound(self) -> FloatArray:
        """Return a y below the solution: there no two resistances reach one half each."""
        steepest = self.linear + self.saturation * self.rate
        return np.asarray(
            np.minimum(-np.log(2.0 * steepest), -np.log(2.0 * self.viscous) / self.power)
        )

    def evaluate(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the left side and its slope."""
        increment = np.exp(y)
        linear = self.linear * increment
        viscous = self.viscous * np.exp(self.power * y)
        total = linear + viscous
        slope = linear
        slope += self.power * viscous
        if self.saturation.any():
            fading = -self.rate * increment
            total -= self.saturation * np.expm1(fading)
            slope -= self.saturation * fading * np.exp(fading)
        slope /= total
        return np.log(total), slope


def _solve(equation: _Equation, overstress: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return Δγ and dΔγ/dq_tr, not a number where there is no solution.

    Newton's method between bounds, from the upper one; a step beyond them is replaced by halving.
    The error left by the last step is of second order in it. Solved points go along until they
    are the greater part, since sorting them out costs as much as an iteration.
    """
    solution = np.full_like(overstress, np.nan)
    slopes = np.full_like(overstress, np.nan)
    left = equation
    points: npt.NDArray[np.intp] = np.arange(len(overstress))
    lower, y = equation.lower_bound(), np.zeros_like(slopes)
    upper = np.full_like(slopes, 1e-6)  # room for the round-off of the scaling
    for iterations_left in reversed(range(MOST_ITERATIONS)):
        value, slope = left.evaluate(y)
        np.copyto(lower, y, where=value < 0.0)
        np.copyto(upper, y, where=value >= 0.0)
        y = y - value / slope
        np.copyto(y, 0.5 * (lower + upper), where=(y < lower) | (y > upper))
        solved = np.abs(value) <= 1e-8 * slope * slope + ROUND_OFF
        if 2 * np.count_nonzero(solved) > len(points) or not iterations_left:
            solution[points[solved]], slopes[points[solved]] = y[solved], slope[solved]
            open_ = ~solved
            points, lower, y, upper = points[open_], lower[open_], y[open_], upper[open_]
            left = _Equation(*(values[open_] for values in left))
        if not points.size:
            break
    increment = np.exp(equation.logarithm + solution)
    return increment, increment / (overstress * slopes)
