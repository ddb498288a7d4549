"""Swift's isotropic hardening, a power of the strain."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.input.entries import over_temperature
from castx.input.units import PURE_NUMBER, STRESS
from castx.materials.rules.flow_rule import Values
from castx.materials.rules.hardening_rule import HardeningRule
from castx.materials.rules.key import PeoplesUnit, RuleKey
from castx.materials.rules.overstress import Points

STRENGTH = RuleKey(
    "strength",
    "strength coefficient K",
    over_temperature(STRESS, least=0.0),
    default=0.0,
    shown=PeoplesUnit("MPa", 1e-6),
)
PRESTRAIN = RuleKey(
    "prestrain", "prestrain ξ0", over_temperature(PURE_NUMBER, above=0.0), default=0.0
)
EXPONENT = RuleKey(
    "exponent",
    "exponent n of the strain",
    over_temperature(PURE_NUMBER, above=0.0, most=1.0),
    default=0.0,
)


class SwiftCurve(NamedTuple):
    """R(ξ) = K ((ξ0 + ξ)ⁿ − ξ0ⁿ), see `hardening_rule.HardeningCurve`.

    With the yield stress K ξ0ⁿ it is Swift's q = K (ξ0 + ξ)ⁿ.

    Attributes:
        offset: K ξ0ⁿ [Pa], shape (points,).
        prestrain: ξ0, shape (points,).
        exponent: n, from 0 to 1, shape (points,).
    """

    offset: FloatArray
    prestrain: FloatArray
    exponent: FloatArray

    @property
    def curved(self) -> BoolArray:
        """Whether R changes at a point, shape (points,)."""
        return np.asarray(self.offset > 0.0)

    @property
    def steepest(self) -> FloatArray:
        """Slope n K ξ0ⁿ⁻¹ at the start, shape (points,)."""
        return self.exponent * self.offset / self.prestrain

    def __call__(self, equivalent: FloatArray) -> FloatArray:
        """Return R(ξ) [Pa], shape (points,)."""
        growth = self.exponent * np.log1p(equivalent / self.prestrain)
        return np.asarray(self.offset * np.expm1(growth))

    def evaluate(self, equivalent: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return R(ξ) [Pa] and ξ dR/dξ, shape (points,)."""
        rise = self(equivalent)
        share = equivalent / (self.prestrain + equivalent)
        return rise, self.exponent * share * (self.offset + rise)

    def after(self, equivalent: FloatArray) -> SwiftCurve:
        """Return R(ξ + Δγ) − R(ξ) as a function of Δγ: ξ0 has become ξ0 + ξ."""
        prestrain = self.prestrain + equivalent
        return SwiftCurve(self.offset + self(equivalent), prestrain, self.exponent)

    def scaled(self, stress: FloatArray, logarithm: FloatArray) -> SwiftCurve:
        """Return R/stress as a function of ξ/exp(logarithm)."""
        prestrain = self.prestrain / np.exp(logarithm)
        return SwiftCurve(self.offset / stress, prestrain, self.exponent)

    def at(self, points: Points) -> SwiftCurve:
        """Return the curve of some of the points."""
        return SwiftCurve(self.offset[points], self.prestrain[points], self.exponent[points])


def curve(values: Values) -> SwiftCurve:
    """Return R(ξ) for K [Pa], ξ0 and n at points."""
    prestrain, exponent = values["prestrain"], values["exponent"]
    return SwiftCurve(values["strength"] * prestrain**exponent, prestrain, exponent)


RULE = HardeningRule(
    name="swift",
    title="Swift",
    summary="The yield stress grows by a power of the strain, without saturation.",
    formula="R = K ((ξ0 + ξ)ⁿ − ξ0ⁿ)",
    source="H. W. Swift, Plastic instability under plane stress, Journal of the Mechanics and "
    "Physics of Solids 1 (1952) 1",
    keys=(STRENGTH, PRESTRAIN, EXPONENT),
    example={"strength": 2.5e8, "prestrain": 2e-3, "exponent": 0.25},
    isotropic=True,
    curve=curve,
)
