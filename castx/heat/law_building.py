"""From the description of an interface's heat transfer to its laws at the pairs."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.case.heat_transfer import InterfaceHeat
from castx.case.interfaces import Interface
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.heat.interface import HeatExchange
from castx.input.problems import among
from castx.transfer.conductance import ConductionLaw
from castx.transfer.patched import PatchedLaw
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
    if heat is None or heat.declared.exchange == "perfect":
        return HeatExchange(interface.name, pairs, "none" if heat is None else "perfect")
    if heat.declared.exchange == "none" and heat.radiation is None and not heat.patches:
        return HeatExchange(interface.name, pairs, "none")
    part_of = _parts_of_pairs(interface, heat, pairs, mesh)
    grey: FloatArray = np.array([_grey_factor(part) for part in heat.parts])
    laws = [part.conduction_law() for part in heat.parts]
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
