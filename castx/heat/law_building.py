"""From the description of an interface's heat transfer to its laws at the pairs."""

from __future__ import annotations

from typing import Literal, cast

import numpy as np

from castx.arrays import FloatArray
from castx.case.heat_transfer import Coating, InterfaceHeat, mean_depth
from castx.case.interfaces import Interface
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.heat.interface import HeatExchange
from castx.input.problems import among
from castx.input.variation import Variation
from castx.transfer.conductance import ConductionLaw, ConstantConductance
from castx.transfer.laws import (
    Coefficient,
    ContactResistance,
    GapLaw,
    Inverse,
    PatchedLaw,
    PressureTerm,
    SolidFractionLaw,
    Varied,
)
from castx.transfer.radiation import facing_factor


def heat_exchange(
    interface: Interface,
    pairs: NodePairs,
    mesh: CastingMesh,
    law: ConductionLaw | None = None,
) -> HeatExchange:
    """Return how heat crosses an interface.

    Args:
        interface: its description.
        pairs: its node pairs.
        mesh: of all bodies.
        law: of the conduction in place of the one described; radiation stays as described.

    Raises:
        CaseError: a patch holds none of its pairs, or has a name that the mesh lacks; on all ranks.
    """
    heat = interface.heat
    if law is not None:
        factor = _grey_factor(heat) if heat is not None else 0.0
        radiation = np.full(len(pairs.areas), factor) if factor > 0.0 else None
        return HeatExchange(interface.name, pairs, "law", law, radiation)
    if heat is None or (heat.law == "none" and heat.radiation is None and not heat.patches):
        return HeatExchange(interface.name, pairs, "none")
    if heat.law == "perfect":
        return HeatExchange(interface.name, pairs, "perfect")
    parts = [heat, *(heat.on(patch) for patch in heat.patches)]
    part_of = _parts_of_pairs(interface, heat, pairs, mesh)
    grey: FloatArray = np.array([_grey_factor(part) for part in parts])
    laws = [conduction_law(part) for part in parts]
    law = laws[0]
    if heat.patches:
        law = PatchedLaw([(np.flatnonzero(part_of == k), own) for k, own in enumerate(laws)])
    return HeatExchange(interface.name, pairs, "law", law, grey[part_of] if grey.any() else None)


def _parts_of_pairs(
    interface: Interface, heat: InterfaceHeat, pairs: NodePairs, mesh: CastingMesh
) -> np.ndarray:
    """Return for each pair 0, or the number of its patch counted from 1."""
    part_of = np.zeros(len(pairs.areas), dtype=np.intp)
    for index, patch in reversed(list(enumerate(heat.patches))):
        if patch.on and patch.on not in mesh.marked:
            named = among(patch.on, sorted(mesh.marked), what="the mesh names")
            raise CaseError(
                f"interface {interface.name}: heat.patches[{index}].on = {patch.on!r}: no faces "
                f"between bodies with this name; {named}"
            )
        part_of[patch.holds(pairs.points, mesh.marked)] = index + 1
    for index in range(len(heat.patches)):
        if mesh.comm.allreduce(int(np.count_nonzero(part_of == index + 1))) == 0:
            raise CaseError(
                f"interface {interface.name}: heat.patches[{index}] holds no node of the interface "
                "that no patch before it holds; check its place (within in m)"
            )
    return part_of


def _grey_factor(heat: InterfaceHeat) -> float:
    return 0.0 if heat.radiation is None else facing_factor(heat.radiation.emissivities)


def conduction_law(heat: InterfaceHeat) -> ConductionLaw:
    """Return the law of an interface or of one of its parts; not for perfect contact."""
    if heat.law == "none":
        return ConstantConductance()
    closed = _closed(heat)
    if heat.law == "solid-fraction":
        return SolidFractionLaw(closed, Varied(cast(Variation, heat.open)))
    layered = heat.law != "constant"
    return GapLaw(
        cast(Literal["limited", "series", "constant"], heat.law),
        closed,
        _gas(heat) if layered and heat.open is None else None,
        None if heat.open is None else Varied(heat.open),
        _pressure_term(heat),
        heat.transition,
    )


def _gas(heat: InterfaceHeat) -> Coefficient | None:
    return None if heat.gas_conductivity is None else Varied(heat.gas_conductivity)


def _closed(heat: InterfaceHeat) -> Coefficient:
    if heat.closed is not None:
        return Varied(heat.closed)
    return Inverse(_resistance(heat, heat.roughness, heat.coating))


def _resistance(
    heat: InterfaceHeat, roughness: tuple[float, ...] | None, coating: Coating | None
) -> ContactResistance:
    fixed = 0.0 if coating is None else coating.resistance
    gas = _gas(heat) if roughness is not None else None
    return ContactResistance(fixed, mean_depth(roughness), gas)


def _pressure_term(heat: InterfaceHeat) -> PressureTerm | None:
    given = heat.pressure
    if given is None:
        return None
    if given.resistance is not None:
        resistance = ContactResistance(given.resistance)
    else:
        owner = given if given.rough else heat
        resistance = _resistance(heat, owner.roughness, owner.coating)
    return PressureTerm(resistance, given.hardness, given.exponent, heat.transition > 0.0)
