"""Penalty method: the pressure of a closed pair grows with its penetration, p_c = λ + ε⟨-g⟩."""

from __future__ import annotations

from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.contact.methods.description import ContactMethod, Key, Settings, UnknownKind
from castx.errors import CaseError
from castx.input.entries import Quantity
from castx.input.units import PENALTY

AUTOMATIC = "auto"
"""The penalty that follows the stiffness of the softer side of an interface."""


class PenaltyKind:
    """A penalty [Pa/m], or the automatic one."""

    def read(self, value: Any) -> float | str:
        """Return the number in SI, or "auto".

        Raises:
            CaseError: neither of both.
        """
        if value == AUTOMATIC:
            return AUTOMATIC
        try:
            return Quantity(PENALTY, above=0.0).read(value)
        except CaseError as error:
            raise CaseError(f'{error}, or "{AUTOMATIC}"') from None


class LinearPairLaw:
    """The force of a linear spring beside a given pressure: f = λ S - ε S g."""

    is_linear = True

    def force(
        self, gaps: FloatArray, areas: FloatArray, stiffness: FloatArray, multipliers: FloatArray
    ) -> FloatArray:
        """Return (λ - ε g) S [N], negative where a pair pulls and therefore opens."""
        return np.asarray(multipliers - stiffness * gaps)

    def slope(
        self, gaps: FloatArray, areas: FloatArray, stiffness: FloatArray, multipliers: FloatArray
    ) -> FloatArray:
        """Return ε S [N/m]."""
        return stiffness


def linear_pair_law(settings: Settings) -> LinearPairLaw:
    """Return the law of the penalty methods, which has no parameters beside ε and λ."""
    return LinearPairLaw()


PENALTY_KEY = Key(
    "penalty",
    PenaltyKind(),
    AUTOMATIC,
    'ε [Pa/m], or "auto": by the stiffness of the softer side at the time, at least of its whole '
    "solid.",
    common=False,
)

METHOD = ContactMethod(
    name="penalty",
    summary=(
        'Penetrate by p/ε, `penalty` ε [Pa/m] or `"auto"`: by the stiffness of the softer side at '
        "the time, at least of its whole solid."
    ),
    formula="p_c = ε⟨-g⟩",
    source="Chiumenti, section 7.1, t_n = ε g_n",
    advice="for comparison with codes that have nothing else",
    unknowns=UnknownKind.DISPLACEMENTS,
    computed_by="castx.contact.soft.SoftContact",
    keys=(PENALTY_KEY,),
    pair_law=linear_pair_law,
    friction=True,
)
