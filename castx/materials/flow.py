"""How a material flows: from its description to numbers at integration points.

Overstress f = q − σ_Y(T) − R(ξ), with the J2 equivalent q = √(3/2) ‖s − β‖, the isotropic hardening
R = H(T) ξ + R_∞(T) (1 − exp(−b ξ)) (linear and Voce 1948) and the back stress β = (2/3) H_k e_vp
(Prager 1956). Rates of the equivalent viscoplastic strain ξ:

    perzyna  ⟨f/η⟩ⁿ (Perzyna 1966)
    bingham  ⟨f⟩/(3η)
    norton   A qⁿ exp(−Q/(R T_K)), without σ_Y, R and β

An implicit step Δt turns each into an overstress over the increment Δγ, V = resistance Δγ^power.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.units import ABSOLUTE_ZERO
from castx.materials.description import MaterialDescription
from castx.materials.material import Material
from castx.tables import Table

GAS_CONSTANT = 8.314462618  # J/mol/K

PLASTIC = "thermo-elasto-plastic"
VISCOPLASTIC = "thermo-elasto-viscoplastic"

LARGEST_LOGARITHM = 690.0
"""Of a resistance that can be represented with room to spare: nothing flows against it."""


class FlowProperties(NamedTuple):
    """Properties of flow at integration points for the temperature and the length of a step.

    Attributes:
        shear_modulus: G [Pa], shape (points,) like all others.
        yield_stress: σ_Y [Pa].
        linear_hardening: H [Pa].
        saturation: R_∞ of Voce's hardening [Pa].
        saturation_rate: its b.
        kinematic_hardening: H_k [Pa].
        viscous_resistance: overstress that an increment Δγ = 1 over the step takes [Pa]; 0 is
            independent of the rate.
        viscous_power: the overstress of Δγ is viscous_resistance Δγ^viscous_power.
    """

    shear_modulus: FloatArray
    yield_stress: FloatArray
    linear_hardening: FloatArray
    saturation: FloatArray
    saturation_rate: FloatArray
    kinematic_hardening: FloatArray
    viscous_resistance: FloatArray
    viscous_power: FloatArray


def isotropic_hardening(properties: FlowProperties, equivalent: FloatArray) -> FloatArray:
    """Return R(ξ) [Pa], shape (points,)."""
    hardening = properties.linear_hardening * equivalent
    if properties.saturation.any():
        hardening -= properties.saturation * np.expm1(-properties.saturation_rate * equivalent)
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
    if law == VISCOPLASTIC and description.law == "norton":
        resistance, power = _norton(
            _given(description.coefficient),
            description.exponent,
            description.activation_energy,
            temperature,
            step,
        )
        return _without_threshold(shear_modulus, resistance, power)
    none = np.zeros_like(temperature)
    resistance, power = none, np.ones_like(temperature)
    if law == VISCOPLASTIC and description.law == "bingham":
        resistance = _given(description.viscosity)(temperature) * (3.0 / step)
    elif law == VISCOPLASTIC:
        power = np.reciprocal(description.exponent(temperature))
        resistance = _given(description.viscosity)(temperature) * np.power(step, -power)
    hardening = description.hardening
    return FlowProperties(
        shear_modulus,
        _given(description.yield_stress)(temperature),
        hardening.linear(temperature),
        hardening.saturation(temperature),
        hardening.rate(temperature),
        description.kinematic_hardening(temperature),
        resistance,
        power,
    )


def liquid_flow(
    material: Material, shear_modulus: FloatArray, temperature: FloatArray, step: float
) -> FlowProperties:
    """Return the properties of a Norton liquid: neither yield stress nor hardening.

    Args:
        material: with `liquid.model = "norton"`.
        shear_modulus: [Pa], shape (points,).
        temperature: [°C], shape (points,).
        step: Δt [s].

    Raises:
        CaseError: the material has no such liquid.
    """
    liquid = material.liquid
    if liquid is None or liquid.model != "norton":
        raise CaseError(f'material {material.name!r} has no liquid with model = "norton"')
    resistance, power = _norton(
        liquid.coefficient, liquid.exponent, liquid.activation_energy, temperature, step
    )
    return _without_threshold(shear_modulus, resistance, power)


def check_law(material: Material, law: str) -> None:
    """Check that a material has what the law of a body needs.

    Raises:
        CaseError: names all keys that are missing or cannot serve, with the cure.
    """
    problems = list(law_problems(material.description, law))
    if problems:
        text = "; ".join(f"{key}: {text}" for key, text in problems)
        raise CaseError(f"material {material.name!r} cannot serve the law {law!r}: {text}")


def law_problems(material: MaterialDescription, law: str) -> Iterator[tuple[str, str]]:
    """Yield the keys of a material that the law of a body lacks, each with the cure."""
    viscous = law == VISCOPLASTIC
    if viscous and material.law == "norton":
        if material.coefficient is None:
            yield "coefficient", 'missing; law = "norton" flows by coefficient q^exponent'
        return
    if viscous and material.viscosity is None:
        cure = f'law = "{material.law}" flows by it; {PLASTIC!r} has none'
        yield "viscosity", f"missing; {cure}"
    if (viscous or law == PLASTIC) and material.yield_stress is None:
        cure = " (0: it flows at every stress)" if viscous else ""
        yield "yield_stress", f"missing; flow begins there{cure}"
    if law == PLASTIC and material.yield_stress is not None:
        if not material.yield_stress.values.any():
            text = "zero at every temperature, so the solid would carry no shear at all"
            yield "yield_stress", f"{text}; give a positive one or use {VISCOPLASTIC!r}"


def _norton(
    coefficient: Table,
    exponent: Table,
    activation_energy: Table,
    temperature: FloatArray,
    step: float,
) -> tuple[FloatArray, FloatArray]:
    """Return resistance and power of q = (rate/(A exp(−Q/(R T_K))))^(1/n)."""
    power: FloatArray = np.reciprocal(exponent(temperature))
    absolute = np.maximum(temperature - ABSOLUTE_ZERO, np.finfo(np.float64).tiny)
    with np.errstate(over="ignore"):
        barrier = activation_energy(temperature) / GAS_CONSTANT / absolute
    logarithm = power * (barrier - np.log(coefficient(temperature)) - np.log(step))
    return np.exp(np.minimum(logarithm, LARGEST_LOGARITHM)), power


def _without_threshold(
    shear_modulus: FloatArray, resistance: FloatArray, power: FloatArray
) -> FlowProperties:
    none = np.zeros_like(resistance)
    return FlowProperties(shear_modulus, none, none, none, none, none, resistance, power)


def _given(table: Table | None) -> Table:
    """Return what `check_law` has found to be there."""
    assert table is not None
    return table
