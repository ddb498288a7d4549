"""Material cards of CalculiX: elasticity, expansion and plasticity over temperature, in SI."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.materials.flow import PLASTIC, isotropic_hardening, law_problems, solid_flow
from castx.materials.material import Material
from castx.tables import Table

STRAINS = np.array([0.0, 1e-3, 2e-3, 5e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0])
"""Plastic strains at which curved hardening is tabled."""
EXTRAPOLATED = 1.0
"""Plastic strain at which straight hardening is tabled beside zero."""


def material_cards(
    material: Material, name: str, law: str, strength: float | None = None
) -> Iterator[str]:
    """Yield the lines of a material.

    Args:
        material: of the body.
        name: of the card.
        law: of the body; "thermo-elastic" has no `*PLASTIC`.
        strength: yield strength in place of that of the material [Pa].

    Raises:
        CaseError: the material has no elastic constants.
    """
    young, poisson = material.young_modulus, material.poisson_ratio
    if young is None or poisson is None:
        raise CaseError(
            f"material {material.name!r} needs young_modulus and poisson_ratio for CalculiX"
        )
    yield f"*MATERIAL, NAME={name}"
    yield "*ELASTIC"
    for temperature in solid_temperatures(material, young, poisson):
        E, nu = (float(table(np.array([temperature]))[0]) for table in (young, poisson))
        yield f"{E:.10g}, {nu:.10g}, {temperature:.10g}"
    if material.expansion is not None:
        reference = reference_temperature(material)
        yield f"*EXPANSION, ZERO={reference:.10g}"
        for temperature in solid_temperatures(material, material.expansion):
            alpha = float(material.expansion(np.array([temperature]))[0])
            yield f"{alpha:.10g}, {temperature:.10g}"
    if flows(material, law):
        yield from _plastic(material, strength)


def flows(material: Material, law: str) -> bool:
    """Return whether a body of a law has a yield stress that CalculiX knows."""
    if law == "thermo-elastic" or any(law_problems(material.description, PLASTIC)):
        return False
    return material.description.yield_stress is not None


def yield_stress(material: Material, temperature: FloatArray) -> FloatArray:
    """Return the yield stress before any hardening at temperatures [°C], of the same shape [Pa]."""
    assert material.description.yield_stress is not None
    return np.asarray(material.description.yield_stress(temperature))


def reference_temperature(material: Material) -> float:
    """Return the temperature from which the mean expansion of a material counts [°C]."""
    if material.expansion_reference is not None:
        return material.expansion_reference
    return material.stress_free_temperature(20.0)


def solid_temperatures(material: Material, *tables: Table) -> list[float]:
    """Return the temperatures of tables at which the material is solid, at least one [°C]."""
    found = np.unique(np.concatenate([table.arguments for table in tables]))
    solidus = material.solidus
    if solidus is not None and found.size > 1:
        found = np.unique(np.append(found[found < solidus], solidus))
    return [float(temperature) for temperature in found]


def _plastic(material: Material, strength: float | None) -> Iterator[str]:
    yield "*PLASTIC"
    assert material.description.yield_stress is not None
    for temperature in solid_temperatures(material, material.description.yield_stress):
        at = np.array([temperature])
        first = float(yield_stress(material, at)[0]) if strength is None else strength
        if first <= 0.0:  # refused by CalculiX; there the next colder row holds
            continue
        for strain, hardening in _hardening(material, temperature):
            yield f"{first + hardening:.10g}, {strain:.10g}, {temperature:.10g}"
        if strength is not None:
            return  # it is known at one temperature alone


def _hardening(material: Material, temperature: float) -> Iterator[tuple[float, float]]:
    """Yield plastic strains and the isotropic hardening there [Pa]."""
    at = np.full(len(STRAINS), temperature)
    flow = solid_flow(material, PLASTIC, np.ones_like(at), at, 1.0)
    stress = isotropic_hardening(flow, STRAINS)
    if not flow.hardening_curves:
        yield 0.0, 0.0
        if stress[-1] > 0.0:
            yield EXTRAPOLATED, float(stress[-1])
        return
    yield from ((float(e), float(s)) for e, s in zip(STRAINS, stress, strict=True))
