"""Strain range and life of the bodies of a die: those that deform and do not freeze."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.case.case import Case
from castx.foundry.alloy import Alloy
from castx.foundry.die_life import Fatigue
from castx.foundry.stress.stage_ends import SolidState
from castx.foundry.stress.strain_cycle import StrainCycle
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.stateful import Arrays, Saved, part_of, saved_parts
from castx.tables import Table

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh

STRAIN_RANGE, LIFE = "strain_range", "life"
"""Names of the fields."""


@dataclass(frozen=True)
class DieSteel:
    """A body of a die as its cycles see it.

    Attributes:
        young_modulus: E over temperature [Pa].
        fatigue: strain-life curve; None: the material has none.
    """

    young_modulus: Table
    fatigue: Fatigue | None = None


class DieSurfaces:
    """Strain ranges of all bodies of a die through the cycles.

    Args:
        mesh: of all bodies.
        steels: those bodies by name.
    """

    def __init__(self, mesh: CastingMesh, steels: Mapping[str, DieSteel]) -> None:
        self._steels = steels
        self._corners = {name: owned_cells(mesh.bodies[name]) for name in steels}
        self._cycles = {
            name: StrainCycle(len(corners), mesh.bodies[name].cell_numbering)
            for name, corners in self._corners.items()
        }

    def update(self, state: SolidState) -> None:
        """Take over the state after an accepted step."""
        for name, cycles in self._cycles.items():
            if name not in state.mesh.bodies:
                continue
            corners = self._corners[name]
            temperature = state.nodal(name, "temperature")[corners].mean(axis=1)
            modulus = self._steels[name].young_modulus(temperature)
            stress = state.cellwise(name, "stress")[: len(corners)] / modulus[:, None]
            plastic = state.cellwise(name, "viscoplastic_strain")[: len(corners)]
            ended = state.process.cycles_ended == state.process.cycle
            cycles.update(state.process.cycle, stress, plastic, temperature, ended)

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return strain range or life [cycles] of the owned cells, (cells,); None: unknown."""
        if name not in (STRAIN_RANGE, LIFE) or body not in self._cycles:
            return None
        steel, cycles = self._steels[body], self._cycles[body]
        if name == STRAIN_RANGE:
            return cycles.strain_range
        if steel.fatigue is None:
            return None
        return steel.fatigue.cycles(cycles.strain_range, steel.young_modulus(cycles.temperature))

    def totals(self) -> dict[str, float]:
        """Return nothing: these are fields."""
        return {}

    def described(self) -> dict[str, Any]:
        """Return nothing."""
        return {}

    def saved(self) -> dict[str, Saved]:
        """Return the cycles of all bodies; collective."""
        return saved_parts(self._cycles)

    def restore(self, arrays: Arrays) -> None:
        """Go on with the cycles of an earlier part; a body that was not followed begins now."""
        for name, cycles in self._cycles.items():
            if part := part_of(arrays, name):
                cycles.restore(part)


def owned_cells(body: BodyMesh) -> IntArray:
    """Return the nodes of the owned cells of a body, (cells, corners)."""
    owned = body.mesh.topology.index_map(body.mesh.topology.dim).size_local
    return np.asarray(body.nodes.dofmap.list[:owned])


def die_materials(case: Case) -> Iterator[tuple[str, Material]]:
    """Yield the bodies of a case that deform and do not freeze, with their materials."""
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        if body.law != "rigid" and body.starts_solid(material.description):
            yield body.name, material


def die_surfaces_of(case: Case, mesh: CastingMesh) -> DieSurfaces:
    """Return the bodies of the die of a case, none if no field asks for them."""
    steels = {}
    if {STRAIN_RANGE, LIFE} & set(case.output.fields) and case.coupling.scheme != "thermal":
        for name, material in die_materials(case):
            assert material.young_modulus is not None
            known = material.description.fatigue is not None
            steels[name] = DieSteel(
                material.young_modulus, Alloy(material).fatigue if known else None
            )
    return DieSurfaces(mesh, steels)
