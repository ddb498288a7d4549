"""Norton's flow rule: creep by a power of the stress, thermally activated."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.input.entries import TEMPERATURES, Tabulated
from castx.input.units import NORTON_COEFFICIENT
from castx.materials.rules.activation import ACTIVATION_ENERGY, barrier
from castx.materials.rules.flow_rule import FlowRule, Values
from castx.materials.rules.key import PeoplesUnit, PlainQuantity, RuleKey
from castx.materials.rules.power_law import EXPONENT, PowerLaw

LARGEST_LOGARITHM = 690.0
"""Of a resistance that can be represented with room to spare: nothing flows against it."""

COEFFICIENT = RuleKey(
    "coefficient",
    "coefficient A",
    Tabulated(PlainQuantity(NORTON_COEFFICIENT, above=0.0), TEMPERATURES),
    written_unit="1/(s Pa^exponent)",
    shown=PeoplesUnit("1/(s Pa^n)", 1.0),
)


def overstress(values: Values, temperature: FloatArray, step: float) -> PowerLaw:
    """Return V(Δγ) = (Δγ/(Δt A exp(−Q/(R T_K))))^(1/n), from Δγ/Δt = A qⁿ exp(−Q/(R T_K)).

    Args:
        values: A [1/(s Paⁿ)], n and Q [J/mol] at points.
        temperature: T [°C], shape (points,).
        step: Δt [s].
    """
    power: FloatArray = np.reciprocal(values["exponent"])
    activation = barrier(values["activation_energy"], temperature)
    logarithm = power * (activation - np.log(values["coefficient"]) - np.log(step))
    return PowerLaw(np.exp(np.minimum(logarithm, LARGEST_LOGARITHM)), power)


RULE = FlowRule(
    name="norton",
    title="Norton's law",
    summary="Creep at every stress, by a power of the equivalent stress.",
    formula="A qⁿ exp(−Q/(R T_K))",
    source="F. H. Norton, The Creep of Steel at High Temperatures (1929)",
    keys=(COEFFICIENT, EXPONENT, ACTIVATION_ENERGY),
    example={"coefficient": 1e-30, "exponent": 5.0, "activation_energy": 1.4e5},
    threshold=False,
    overstress=overstress,
    flows_by="coefficient q^exponent",
)
