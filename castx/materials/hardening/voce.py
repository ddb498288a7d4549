"""Voce's isotropic hardening, which saturates."""

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

SATURATION = RuleKey(
    "saturation",
    "hardening at saturation R_∞",
    over_temperature(STRESS, least=0.0),
    default=0.0,
    shown=PeoplesUnit("MPa", 1e-6),
)
RATE = RuleKey(
    "rate", "rate of saturation b", over_temperature(PURE_NUMBER, above=0.0), default=0.0
)


class VoceCurve(NamedTuple):
    """R(ξ) = R_∞ (1 − exp(−b ξ)), see `hardening_rule.HardeningCurve`.

    Attributes:
        saturation: R_∞ [Pa], shape (points,).
        rate: b, shape (points,).
    """

    saturation: FloatArray
    rate: FloatArray

    @property
    def curved(self) -> BoolArray:
        """Whether R changes at a point, shape (points,)."""
        return np.asarray(self.steepest > 0.0)

    @property
    def steepest(self) -> FloatArray:
        """Slope b R_∞ at the start, shape (points,)."""
        return self.saturation * self.rate

    def __call__(self, equivalent: FloatArray) -> FloatArray:
        """Return R(ξ) [Pa], shape (points,)."""
        return np.asarray(-(self.saturation * np.expm1(-self.rate * equivalent)))

    def evaluate(self, equivalent: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return R(ξ) [Pa] and ξ dR/dξ, shape (points,)."""
        fading = -self.rate * equivalent
        rise = -(self.saturation * np.expm1(fading))
        return rise, -(self.saturation * fading * np.exp(fading))

    def after(self, equivalent: FloatArray) -> VoceCurve:
        """Return R(ξ + Δγ) − R(ξ) as a function of Δγ: R_∞ has become R_∞ exp(−b ξ)."""
        return VoceCurve(self.saturation * np.exp(-self.rate * equivalent), self.rate)

    def scaled(self, stress: FloatArray, logarithm: FloatArray) -> VoceCurve:
        """Return R/stress as a function of ξ/exp(logarithm)."""
        return VoceCurve(self.saturation / stress, self.rate * np.exp(logarithm))

    def at(self, points: Points) -> VoceCurve:
        """Return the curve of some of the points."""
        return VoceCurve(self.saturation[points], self.rate[points])


def curve(values: Values) -> VoceCurve:
    """Return R(ξ) for R_∞ [Pa] and b at points."""
    return VoceCurve(values["saturation"], values["rate"])


RULE = HardeningRule(
    name="voce",
    title="Voce",
    summary="The yield stress grows towards a saturation.",
    formula="R = R_∞ (1 − exp(−b ξ))",
    source="E. Voce, The relationship between stress and strain for homogeneous deformation, "
    "Journal of the Institute of Metals 74 (1948) 537",
    keys=(SATURATION, RATE),
    example={"saturation": 2e7, "rate": 50.0},
    isotropic=True,
    curve=curve,
)
