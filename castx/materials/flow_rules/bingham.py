"""Bingham's flow rule: a Newtonian fluid above its yield stress."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.materials.rules.flow_rule import FlowRule, Values
from castx.materials.rules.power_law import PowerLaw
from castx.materials.rules.viscosity import VISCOSITY


def overstress(values: Values, temperature: FloatArray, step: float) -> PowerLaw:
    """Return V(Δγ) = 3η Δγ/Δt, the inverse of Δγ/Δt = ⟨f⟩/(3η).

    Args:
        values: η [Pa s] at points.
        temperature: [°C], shape (points,).
        step: Δt [s].
    """
    return PowerLaw(values["viscosity"] * (3.0 / step), np.ones_like(temperature))


RULE = FlowRule(
    name="bingham",
    title="Bingham's law",
    summary="Linear viscous flow above the yield stress; η is the viscosity in shear.",
    formula="⟨f⟩/(3η)",
    source="E. C. Bingham, Fluidity and Plasticity (1922)",
    keys=(VISCOSITY,),
    example={"viscosity": 1e9},
    threshold=True,
    overstress=overstress,
)
