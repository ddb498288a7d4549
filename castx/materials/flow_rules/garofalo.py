"""Garofalo's flow rule: creep by the hyperbolic sine of the stress, thermally activated."""

from __future__ import annotations

import math

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import TEMPERATURES, Tabulated, over_temperature
from castx.input.units import STRESS, Dimension
from castx.materials.rules.activation import ACTIVATION_ENERGY, barrier
from castx.materials.rules.flow_rule import FlowRule, Values
from castx.materials.rules.key import PeoplesUnit, PlainQuantity, RuleKey
from castx.materials.rules.overstress import RateOverstress
from castx.materials.rules.power_law import EXPONENT

LARGEST_BARRIER = 1e5
"""Of Q/(R T_K): at temperatures where it is larger nothing creeps, and numbers stay finite."""

STRAIGHT = 300.0
"""Of ln sinh(q/σ0), above which the hyperbolic sine is an exponential to all digits."""

RATE = RuleKey(
    "creep_rate",
    "rate A at sinh(q/σ0) = 1 without thermal activation",
    Tabulated(PlainQuantity(Dimension("a creep rate", "1/s"), above=0.0), TEMPERATURES),
)
STRESS_SCALE = RuleKey(
    "breakdown_stress",
    "stress σ0 above which the rate grows exponentially",
    over_temperature(STRESS, above=0.0),
    shown=PeoplesUnit("MPa", 1e-6),
)


def stress_of_rate(
    log_rate: FloatArray, scale: FloatArray, exponent: FloatArray, log_reference: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return q = σ0 asinh(e^z) and dq/d(ln ε̇), with z = ln(ε̇/(A exp(−Q/(R T_K))))/n.

    Args:
        log_rate: ln ε̇ of rates in 1/s, shape (points,) like all others.
        scale: σ0 [Pa].
        exponent: n.
        log_reference: ln(A exp(−Q/(R T_K))).
    """
    z = (log_rate - log_reference) / exponent
    curved = np.arcsinh(np.exp(np.minimum(z, STRAIGHT)))
    stress = scale * np.where(z < STRAIGHT, curved, z + math.log(2.0))
    # e^z/√(1 + e^2z), for all z
    share = np.exp(-0.5 * np.logaddexp(0.0, -2.0 * z))
    return stress, scale / exponent * share


def rate_of_stress(
    stress: FloatArray, scale: FloatArray, exponent: FloatArray, log_reference: FloatArray
) -> FloatArray:
    """Return ln ε̇ = n ln sinh(q/σ0) + ln(A exp(−Q/(R T_K))), the inverse of `stress_of_rate`."""
    x = stress / scale
    log_sinh = x + np.log(-np.expm1(-2.0 * x)) - math.log(2.0)
    return np.asarray(exponent * log_sinh + log_reference)


def overstress(values: Values, temperature: FloatArray, step: float) -> RateOverstress:
    """Return V(Δγ) = σ0 asinh((Δγ/(Δt A exp(−Q/(R T_K))))^(1/n)).

    It is the inverse of Δγ/Δt = A sinh(q/σ0)ⁿ exp(−Q/(R T_K)).

    Args:
        values: A [1/s], σ0 [Pa], n and Q [J/mol] at points.
        temperature: T [°C], shape (points,).
        step: Δt [s].
    """
    activation = np.minimum(barrier(values["activation_energy"], temperature), LARGEST_BARRIER)
    log_reference = np.log(values["creep_rate"]) - activation
    parameters = (values["breakdown_stress"], values["exponent"], log_reference)
    return RateOverstress.over_step(stress_of_rate, rate_of_stress, parameters, step)


RULE = FlowRule(
    name="garofalo",
    title="Garofalo's law",
    summary="Creep at every stress, by a power at low and an exponential at high stresses.",
    formula="A sinh(q/σ0)ⁿ exp(−Q/(R T_K))",
    source="F. Garofalo, Fundamentals of Creep and Creep-Rupture in Metals (1965)",
    keys=(RATE, STRESS_SCALE, EXPONENT, ACTIVATION_ENERGY),
    example={
        "creep_rate": 1e9,
        "breakdown_stress": 2.5e7,
        "exponent": 5.0,
        "activation_energy": 1.5e5,
    },
    threshold=False,
    overstress=overstress,
    flows_by="creep_rate sinh(q/breakdown_stress)^exponent",
)
