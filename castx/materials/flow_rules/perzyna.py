"""Perzyna's flow rule: the overstress over the viscosity, to a power."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from castx.arrays import FloatArray
from castx.materials.rules.flow_rule import FlowRule, Values
from castx.materials.rules.power_law import EXPONENT, PowerLaw
from castx.materials.rules.viscosity import VISCOSITY, TableInPascalSeconds
from castx.tables import Table


def overstress(values: Values, temperature: FloatArray, step: float) -> PowerLaw:
    """Return V(Δγ) = η (Δγ/Δt)^(1/n), the inverse of Δγ/Δt = ⟨f/η⟩ⁿ.

    Args:
        values: η [Pa s^(1/n)] and n at points.
        temperature: [°C], shape (points,).
        step: Δt [s].
    """
    power = np.reciprocal(values["exponent"])
    return PowerLaw(values["viscosity"] * np.power(step, -power), power)


def problems(tables: Mapping[str, Table]) -> Iterator[tuple[str, str]]:
    """Yield a viscosity written in Pa·s with an exponent other than 1."""
    if isinstance(tables.get("viscosity"), TableInPascalSeconds):
        if not (tables["exponent"].values == 1.0).all():
            text = "a unit of Pa·s fits exponent 1 only; give a plain number in Pa·s^(1/exponent)"
            yield "viscosity", text


RULE = FlowRule(
    name="perzyna",
    title="Perzyna's law",
    summary="Viscoplastic flow above the yield stress, by a power of the overstress.",
    formula="⟨f/η⟩ⁿ",
    source="P. Perzyna, Fundamental problems in viscoplasticity, Advances in Applied Mechanics 9 "
    "(1966) 243; Chiumenti, section 2.2",
    keys=(VISCOSITY, EXPONENT),
    example={"viscosity": 5e7, "exponent": 5.0},
    threshold=True,
    overstress=overstress,
    problems=problems,
    is_default=True,
)
