"""Linear isotropic hardening."""

from __future__ import annotations

from castx.arrays import FloatArray
from castx.input.entries import over_temperature
from castx.input.units import STRESS
from castx.materials.rules.flow_rule import Values
from castx.materials.rules.hardening_rule import HardeningRule
from castx.materials.rules.key import PeoplesUnit, RuleKey

LINEAR = RuleKey(
    "linear",
    "hardening modulus H",
    over_temperature(STRESS, least=0.0),
    default=0.0,
    shown=PeoplesUnit("MPa", 1e-6),
)


def modulus(values: Values) -> FloatArray:
    """Return H [Pa] of R = H ξ."""
    return values["linear"]


RULE = HardeningRule(
    name="linear",
    title="",
    summary="The yield stress grows linearly with the equivalent plastic strain.",
    formula="R = H ξ",
    source="J. C. Simo, T. J. R. Hughes, Computational Inelasticity (1998), section 1.2.2",
    keys=(LINEAR,),
    example={"linear": 5e8},
    isotropic=True,
    modulus=modulus,
)
