"""Implicit Euler step of J2 viscoplasticity at integration points, and its consistent tangent.

Deviatoric stress s, back stress β, equivalent viscoplastic strain ξ. With the trial stress s_tr =
2G (e − e_vp,n) and q_tr = √(3/2) ‖s_tr − β_n‖ the direction of flow n, that of s_tr − β_n, is known
beforehand, and the increment Δγ of ξ follows from one scalar equation for each point,

    (3G + H_k) Δγ + R(ξ_n + Δγ) − R(ξ_n) + V(Δγ) = q_tr − σ_Y − R(ξ_n),

where the right side, the trial overstress, is positive; else the step is elastic. V is the
overstress that drives the flow through its increment, of one of `castx.materials.flow_rules` (for
Perzyna's V = η (Δγ/Δt)^(1/n)); V = 0 is rate-independent plasticity. R is the sum of the isotropic
rules in `castx.materials.hardening`, H_k the modulus of the kinematic ones.

Source of the algorithm, radial return with its consistent tangent: Simo and Hughes, Computational
Inelasticity (1998), chapter 3; of the overstress: Perzyna, Fundamental problems in viscoplasticity,
Advances in Applied Mechanics 9 (1966).

Tensors are arrays of components, shape (points, 4): xx, yy, zz, xy, or (points, 6): xx, yy, zz, xy,
xz, yz; a shear component counts twice in norms and contractions.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray
from castx.errors import ConvergenceError
from castx.materials.flow import FlowProperties, isotropic_hardening
from castx.materials.rules.hardening_rule import HardeningCurve
from castx.materials.rules.overstress import Overstress, Points

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

        s = s_tr − √6 G Δγ n
        ds/de = 2G (1 − 3GΔγ/q_tr) I_dev + 2G (3GΔγ/q_tr − 3G dΔγ/dq_tr) n⊗n

    The new viscoplastic strain is the old one plus `viscoplastic_strain` of the returned state.

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
        increment[flowing], slope[flowing] = _increment(
            overstress[flowing], equivalent[flowing], properties.at(flowing)
        )
        _check(increment, slope, overstress)

    shear = properties.shear_modulus
    stress = trial - (np.sqrt(6.0) * shear * increment)[:, None] * direction
    share = 3.0 * shear * increment / np.maximum(trial_equivalent, TINY)
    isotropic = 2.0 * shear * (1.0 - share)
    radial = 2.0 * shear * (share - 3.0 * shear * slope)
    return Returned(stress, increment, direction, isotropic, radial)


def viscoplastic_strain(returned: Returned) -> FloatArray:
    """Return the increment √(3/2) Δγ n of the viscoplastic strain, shape (points, components)."""
    return np.asarray((np.sqrt(1.5) * returned.increment)[:, None] * returned.direction)


def plastic_work(returned: Returned) -> FloatArray:
    """Return the work s : Δe_vp of the step per volume [J/m³], shape (points,)."""
    along = product(returned.stress, returned.direction)
    return np.asarray(np.sqrt(1.5) * returned.increment * along)


def tensor_norm(tensor: FloatArray) -> FloatArray:
    """Return the norm √(t:t) of tensors by components, shape (points,)."""
    return np.asarray(np.sqrt(product(tensor, tensor)))


def product(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the contractions a:b of tensors by components, shape (points,)."""
    return np.asarray((a * b) @ _weights(a))


def _weights(tensor: FloatArray) -> FloatArray:
    """Return the multiplicity of each component in a contraction."""
    return np.array([1.0] * 3 + [2.0] * (tensor.shape[1] - 3))


def _check(increment: FloatArray, slope: FloatArray, overstress: FloatArray) -> None:
    """Refuse increments that are not finite; a failed iteration gives NaN."""
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
    linear = 3.0 * properties.shear_modulus + properties.hardening_modulus
    linear += properties.kinematic_modulus
    viscous = properties.overstress
    curves = [curve.after(equivalent) for curve in properties.hardening_curves]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        slope: FloatArray = np.reciprocal(linear + viscous.modulus)
        increment = overstress * slope
        curved = viscous.curved
        for curve in curves:
            curved = curved | curve.curved
        if curved.any():
            equation = _Equation.of(
                overstress[curved], linear[curved], viscous.at(curved),
                [curve.at(curved) for curve in curves],
            )  # fmt: skip
            increment[curved], slope[curved] = _solve(equation, overstress[curved])
    return increment, slope


class _Equation(NamedTuple):
    """ln(A eʸ + V(eʸ) + R(eʸ)) = 0 for y = ln(Δγ/Δγ_max), one per point.

    All terms are parts of the trial overstress: A Δγ of elasticity and linear hardening, V of the
    flow rule and R of the curves of hardening. Δγ_max is the increment if the stronger of A and V
    were alone, so that max(A, V) = 1 at y = 0 and the solution has y ≤ 0. With a power law for V
    and without R the left side is convex and its slope lies between 1 and the power of V: Newton's
    method cannot fail, however far apart the resistances are.
    """

    logarithm: FloatArray  # ln Δγ_max
    linear: FloatArray  # A
    viscous: Overstress  # V
    curves: tuple[HardeningCurve, ...]  # parts of R

    @classmethod
    def of(
        cls,
        overstress: FloatArray,
        linear: FloatArray,
        viscous: Overstress,
        curves: Sequence[HardeningCurve],
    ) -> _Equation:
        """Return the equation scaled by the trial overstress and Δγ_max."""
        log_linear = np.log(linear / overstress)
        logarithm = np.minimum(-log_linear, viscous.logarithm(overstress))
        return cls(
            logarithm,
            np.exp(log_linear + logarithm),
            viscous.scaled(overstress, logarithm),
            tuple(curve.scaled(overstress, logarithm) for curve in curves),
        )

    def at(self, points: Points) -> _Equation:
        """Return the equations of some of the points."""
        return _Equation(
            self.logarithm[points],
            self.linear[points],
            self.viscous.at(points),
            tuple(curve.at(points) for curve in self.curves),
        )

    def lower_bound(self) -> FloatArray:
        """Return a y below the solution: there no two resistances reach one half each."""
        steepest = self.linear
        for curve in self.curves:
            steepest = steepest + curve.steepest
        return np.asarray(np.minimum(-np.log(2.0 * steepest), self.viscous.logarithm_of_half()))

    def evaluate(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the left side and its slope."""
        increment = np.exp(y)
        linear = self.linear * increment
        viscous, viscous_slope = self.viscous.evaluate(y)
        total = linear + viscous
        slope = linear
        slope += viscous_slope
        for curve in self.curves:
            hardening, hardening_slope = curve.evaluate(increment)
            total += hardening
            slope += hardening_slope
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
            left = left.at(open_)
        if not points.size:
            break
    increment = np.exp(equation.logarithm + solution)
    return increment, increment / (overstress * slopes)
