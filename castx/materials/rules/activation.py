"""Thermal activation: the key `activation_energy` and the exponent of the Arrhenius factor."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import over_temperature
from castx.input.units import ABSOLUTE_ZERO
from castx.input.units import ACTIVATION_ENERGY as ENERGY_PER_MOLE
from castx.materials.rules.key import PeoplesUnit, RuleKey

GAS_CONSTANT = 8.314462618  # J/mol/K

ACTIVATION_ENERGY = RuleKey(
    "activation_energy",
    "activation energy Q",
    over_temperature(ENERGY_PER_MOLE, least=0.0),
    default=0.0,
    shown=PeoplesUnit("kJ/mol", 1e-3),
)


def barrier(activation_energy: FloatArray, temperature: FloatArray) -> FloatArray:
    """Return Q/(R T_K), by whose negative exponential a rate is activated.

    Args:
        activation_energy: Q [J/mol], shape (points,).
        temperature: [°C], shape (points,); at absolute zero the barrier is infinite or very large.
    """
    absolute = np.maximum(temperature - ABSOLUTE_ZERO, np.finfo(np.float64).tiny)
    with np.errstate(over="ignore"):
        return np.asarray(activation_energy / GAS_CONSTANT / absolute)
