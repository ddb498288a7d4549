"""Softened contact: surfaces touch before the gap closes, and harden exponentially."""

from __future__ import annotations

import math

import numpy as np

from castx.arrays import FloatArray
from castx.contact.methods.description import ContactMethod, Key, Settings, UnknownKind
from castx.contact.methods.penalty import PENALTY_KEY
from castx.input.entries import Quantity
from castx.input.units import LENGTH

STEEPEST = 6.0
"""Of x = 1 - g/c, beyond which the force goes on along its tangent: a step far into the other
body would overflow the exponential."""

AT_CLOSURE = 2.0 * math.e - 1.0
"""Derivative of x (e^x - 1) at x = 1, where the gap is zero and the slope shall be ε."""


class ExponentialPairLaw:
    """Pressure that begins at the clearance c: p_c = ε c x (e^x - 1)/(2e - 1) with x = 1 - g/c.

    At g = 0 it has the slope ε of the penalty method. Beyond the clearance the force is negative,
    proportional to the distance, so that the pair opens.

    Args:
        clearance: c [m].
    """

    is_linear = False

    def __init__(self, clearance: float) -> None:
        self._clearance = clearance

    def force(
        self, gaps: FloatArray, areas: FloatArray, stiffness: FloatArray, multipliers: FloatArray
    ) -> FloatArray:
        """Return p_c S [N], negative beyond the clearance."""
        x = 1.0 - gaps / self._clearance
        y = np.clip(x, 0.0, STEEPEST)
        shape = y * np.expm1(y) + _slope(y) * np.maximum(x - STEEPEST, 0.0)
        shape = np.where(x < 0.0, x, shape)
        return np.asarray(stiffness * (self._clearance / AT_CLOSURE) * shape)

    def slope(
        self, gaps: FloatArray, areas: FloatArray, stiffness: FloatArray, multipliers: FloatArray
    ) -> FloatArray:
        """Return -∂f/∂g [N/m]."""
        x = 1.0 - gaps / self._clearance
        shape = np.where(x < 0.0, 1.0, _slope(np.clip(x, 0.0, STEEPEST)))
        return np.asarray(stiffness * shape / AT_CLOSURE)


def _slope(x: FloatArray) -> FloatArray:
    """Return the derivative of x (e^x - 1)."""
    return np.asarray(np.expm1(x) + x * np.exp(x))


CLEARANCE = Key(
    "clearance",
    Quantity(LENGTH, above=0.0),
    1e-5,
    "Gap c [m] from which surfaces begin to touch, of the size of their roughness; heat counts "
    "gaps from there.",
    common=False,
)


def exponential_pair_law(settings: Settings) -> ExponentialPairLaw:
    """Return the law of an interface."""
    return ExponentialPairLaw(float(settings.get(CLEARANCE.name, CLEARANCE.default)))


METHOD = ContactMethod(
    name="exponential",
    summary=(
        "Softened: pressure begins at the gap `clearance`, and hardens exponentially to the slope "
        "ε of `penalty` where the gap closes."
    ),
    formula="p_c = ε c x (e^x - 1)/(2e - 1), x = ⟨1 - g/c⟩",
    source="softened contact with an exponential pressure-overclosure, as usual in contact codes",
    advice="for rough surfaces that touch at their peaks first",
    unknowns=UnknownKind.DISPLACEMENTS,
    computed_by="castx.contact.soft.SoftContact",
    keys=(PENALTY_KEY, CLEARANCE),
    pair_law=exponential_pair_law,
)
