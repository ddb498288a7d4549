"""Prager's linear kinematic hardening."""

from __future__ import annotations

from castx.arrays import FloatArray
from castx.input.entries import over_temperature
from castx.input.units import STRESS
from castx.materials.rules.flow_rule import Values
from castx.materials.rules.hardening_rule import HardeningRule
from castx.materials.rules.key import PeoplesUnit, RuleKey

KINEMATIC = RuleKey(
    "kinematic_hardening",
    "kinematic hardening modulus H_k",
    over_temperature(STRESS, least=0.0),
    default=0.0,
    shown=PeoplesUnit("MPa", 1e-6),
)


def modulus(values: Values) -> FloatArray:
    """Return H_k [Pa] of the back stress β = (2/3) H_k e_vp."""
    return values["kinematic_hardening"]


RULE = HardeningRule(
    name="prager",
    title="Prager",
    summary="The yield surface moves in proportion to the viscoplastic strain.",
    formula="β = (2/3) H_k e_vp",
    source="W. Prager, A new method of analyzing stresses and strains in work-hardening plastic "
    "solids, Journal of Applied Mechanics 23 (1956) 493",
    keys=(KINEMATIC,),
    example={"kinematic_hardening": 1e9},
    isotropic=False,
    modulus=modulus,
)
