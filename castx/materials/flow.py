"""Flow of a material: from its description to numbers at integration points.

With the J2 equivalent q = √(3/2) ‖s − β‖, the overstress is

    f = q − σ_Y(T) − R(ξ)     (rules with a yield stress and hardening, as Perzyna's)
    f = q                     (rules without, as Norton's, and all liquids)

where the isotropic hardening R and the back stress β are sums of the rules in `hardening`. A rule
in `flow_rules` states the rate of the equivalent viscoplastic strain ξ as a function of f. An
implicit step Δt turns it into V(Δγ), the overstress over the increment Δγ of ξ.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.materials.description import MaterialDescription
from castx.materials.granular import GRANULAR
from castx.materials.inelastic import (
    FLOW_RULES,
    ISOTROPIC_RULES,
    KINEMATIC_RULES,
    LIQUID_RULES,
)
from castx.materials.material import Material
from castx.materials.rules.hardening_rule import HardeningCurve
from castx.materials.rules.overstress import Overstress, Points
from castx.materials.rules.power_law import PowerLaw

PLASTIC = "thermo-elasto-plastic"
VISCOPLASTIC = "thermo-elasto-viscoplastic"

class FlowProperties(NamedTuple):
    """Properties of flow at integration points for the temperature and the length of a step.

    Attributes:
        shear_modulus: G [Pa], shape (points,).
        yield_stress: σ_Y [Pa], shape (points,).
        hardening_modulus: H, slope of the linear isotropic hardening [Pa], shape (points,).
        hardening_curves: isotropic hardening that is not linear.
        kinematic_modulus: H_k of the back stress β = (2/3) H_k e_vp [Pa], shape (points,).
        overstress: V(Δγ) of the step.
    """

    shear_modulus: FloatArray
    yield_stress: FloatArray
    hardening_modulus: FloatArray
    hardening_curves: tuple[HardeningCurve, ...]
    kinematic_modulus: FloatArray
    overstress: Overstress

    def at(self, points: Points) -> FlowProperties:
        """Return the properties of some of the points."""
        return FlowProperties(
            self.shear_modulus[points],
            self.yield_stress[points],
            self.hardening_modulus[points],
            tuple(curve.at(points) for curve in self.hardening_curves),
            self.kinematic_modulus[points],
            self.overstress.at(points),
        )


def isotropic_hardening(properties: FlowProperties, equivalent: FloatArray) -> FloatArray:
    """Return R(ξ) [Pa], the sum of all isotropic hardening rules, shape (points,)."""
    hardening = properties.hardening_modulus * equivalent
    for curve in properties.hardening_curves:
        hardening += curve(equivalent)
    return np.asarray(hardening)


def solid_flow(
    material: Material, law: str, shear_modulus: FloatArray, temperature: FloatArray, step: float
) -> FlowProperties:
    """Return the properties of the solid.

    Args:
        material: checked by `check_law`.
        law: of the body, "thermo-elasto-plastic" or "thermo-elasto-viscoplastic".
        shear_modulus: [Pa], shape (points,).
        temperature: [°C], shape (points,).
        step: Δt [s].

    Raises:
        CaseError: the law does not flow, or the material lacks what it needs.
    """
    if law not in (PLASTIC, VISCOPLASTIC):
        raise CaseError(f"the law {law!r} does not flow; {PLASTIC!r} and {VISCOPLASTIC!r} do")
    check_law(material, law)
    description = material.description
    rule = FLOW_RULES[description.law]
    overstress: Overstress = PowerLaw.none(temperature)
    if law == VISCOPLASTIC:
        overstress = rule.over_step(description, temperature, step)
        if not rule.threshold:
            return _without_threshold(shear_modulus, overstress)
    hardening, none = description.hardening, np.zeros_like(temperature)
    straight, curves = none, []
    for isotropic in ISOTROPIC_RULES:
        values = isotropic.values(hardening, temperature)
        if isotropic.modulus is not None:
            straight = straight + isotropic.modulus(values)
        elif isotropic.curve is not None and isotropic.acts(hardening):
            curves.append(isotropic.curve(values))
    back = none
    for kinematic in KINEMATIC_RULES:
        assert kinematic.modulus is not None
        back = back + kinematic.modulus(kinematic.values(description, temperature))
    assert description.yield_stress is not None  # as `check_law` has found
    return FlowProperties(
        shear_modulus,
        description.yield_stress(temperature),
        straight,
        tuple(curves),
        back,
        overstress,
    )


def liquid_flow(
    material: Material, shear_modulus: FloatArray, temperature: FloatArray, step: float
) -> FlowProperties:
    """Return the properties of a liquid that flows by a rule: neither yield stress nor hardening.

    Args:
        material: with the name of a flow rule without threshold as `liquid.model`.
        shear_modulus: [Pa], shape (points,).
        temperature: [°C], shape (points,).
        step: Δt [s].

    Raises:
        CaseError: the material has no such liquid.
    """
    liquid = material.liquid
    if liquid is None or liquid.is_newtonian:
        models = " or ".join(f'"{name}"' for name in LIQUID_RULES)
        raise CaseError(f"material {material.name!r} has no liquid with model = {models}")
    rule = LIQUID_RULES[liquid.model]
    return _without_threshold(shear_modulus, rule.over_step(liquid, temperature, step))


def check_law(material: Material, law: str) -> None:
    """Check that a material has the data for the law of a body.

    Raises:
        CaseError: names all keys that are missing or cannot serve, with the cure.
    """
    problems = list(law_problems(material.description, law))
    if problems:
        text = "; ".join(f"{key}: {text}" for key, text in problems)
        raise CaseError(f"material {material.name!r} cannot serve the law {law!r}: {text}")


def law_problems(material: MaterialDescription, law: str) -> Iterator[tuple[str, str]]:
    """Yield the keys of a material that the law of a body lacks, each with the cure."""
    if law == GRANULAR:
        yield from _granular_problems(material)
        return
    viscous, rule = law == VISCOPLASTIC, FLOW_RULES[material.law]
    if viscous:
        cure = f"; {PLASTIC!r} has none" if rule.threshold else ""
        for key in rule.needed:
            if getattr(material, key) is None:
                yield key, f'missing; law = "{rule.name}" flows by {rule.flows_by}{cure}'
        if not rule.threshold:
            return
    if (viscous or law == PLASTIC) and material.yield_stress is None:
        cure = " (0: it flows at every stress)" if viscous else ""
        yield "yield_stress", f"missing; flow begins there{cure}"
    if law == PLASTIC and material.yield_stress is not None:
        if not material.yield_stress.values.any():
            text = "zero at every temperature, so the solid would carry no shear at all"
            yield "yield_stress", f"{text}; give a positive one or use {VISCOPLASTIC!r}"


def _granular_problems(material: MaterialDescription) -> Iterator[tuple[str, str]]:
    if material.granular is None:
        keys = "granular = { cohesion = ..., friction_angle = ... }"
        text = f"missing; grains yield by {keys}, as those of sand-silica"
        yield "granular", f'{text}; the law "rigid" has none'
    if material.liquid is not None:
        text = f'given, and grains do not melt; leave it out, say "none", or use {PLASTIC!r}'
        yield "liquid", text


def _without_threshold(shear_modulus: FloatArray, overstress: Overstress) -> FlowProperties:
    none = np.zeros_like(shear_modulus)
    return FlowProperties(shear_modulus, none, none, (), none, overstress)
