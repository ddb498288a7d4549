"""Quantities of tearing and cracking that a case requests, followed in all bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from castx.arrays import FloatArray
from castx.case.bodies import Body
from castx.case.case import Case
from castx.foundry.alloy import Alloy
from castx.foundry.front.windows import Window
from castx.foundry.hot_tearing import BRIDGED, VULNERABLE
from castx.foundry.stress.cold_cracks import BodyColdCracks
from castx.foundry.stress.strains import BodyStrains, CoolingState, Shrinking
from castx.foundry.suction import CUT_OFFS
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.materials.thermal_strain import shrinkage_strain
from castx.stateful import Arrays, Saved, joined, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh

BRITTLE = ("brittle_strain", "brittle_time", "brittle_strain_index")
MARGIN = "tearing_margin"
COLD_CRACKS = "cold_crack_index"


@dataclass(frozen=True)
class FreezingMetal:
    """Metal for `BodyStrains`; the attributes are those of `strains.FallingQuantity`."""

    name: str
    windows: Mapping[float, Window]
    shrinking: Shrinking

    @classmethod
    def of(cls, material: Material, prescribed: bool) -> FreezingMetal:
        """Return the ranges from f = 0.9 to 0.99 and to the cut-offs of the tearing margin.

        Args:
            material: of the body.
            prescribed: whether its temperature is, so that it has no enthalpy.
        """
        ends = sorted({BRIDGED, *(1.0 - cut_off for cut_off in CUT_OFFS)})
        window = Window.of_temperatures if prescribed else Window.of_enthalpies
        windows = {end: window(material.enthalpy, VULNERABLE, end) for end in ends}
        name = "temperature" if prescribed else "enthalpy"
        return cls(name, windows, partial(shrinkage_strain, material))


class Cracks:
    """Strain of the mush and cold-crack index of the bodies for which they are asked.

    Args:
        strains: of the bodies that freeze and deform, by name.
        cold: of those that have a tensile strength and deform, by name.
    """

    def __init__(
        self, strains: Mapping[str, BodyStrains], cold: Mapping[str, BodyColdCracks]
    ) -> None:
        self._parts: Mapping[str, Mapping[str, BodyStrains] | Mapping[str, BodyColdCracks]]
        self._strains, self._cold = strains, cold
        self._parts = {"strains": strains, "cold": cold}

    def update(self, snapshot: CoolingState) -> None:
        """Take over the state after an accepted step; collective."""
        for bodies in self._parts.values():
            for name, body in bodies.items():
                if name in snapshot.mesh.bodies:
                    body.update(snapshot)

    def strains(self, body: str) -> BodyStrains | None:
        """Return the strains of a body; None: it does not freeze, or nothing asks for them."""
        return self._strains.get(body)

    def cold_crack_index(self, body: str) -> FloatArray | None:
        """Return the index of the local cells of a body, (cells,); None: it has none."""
        return self._cold[body].index if body in self._cold else None

    def saved(self) -> dict[str, Saved]:
        """Return the state of all bodies; collective."""
        return joined({name: saved_parts(bodies) for name, bodies in self._parts.items()})

    def restore(self, arrays: Arrays) -> None:
        """Restore the state of each body; one that was not followed begins now."""
        for kind, bodies in self._parts.items():
            of_kind = part_of(arrays, kind)
            for name, body in bodies.items():
                if part := part_of(of_kind, name):
                    body.restore(part)


def cracks_of(case: Case, mesh: CastingMesh) -> Cracks:
    """Return the crack quantities to follow for the fields of a case."""
    fields = set(case.output.fields)
    strains, cold = {}, {}
    if case.coupling.scheme == "thermal":
        return Cracks({}, {})
    prescribed = case.coupling.scheme == "mechanical"
    for body, material in deforming(case):
        freezes = not body.starts_solid(material.description)
        if freezes and fields & {*BRITTLE, MARGIN}:
            metal = FreezingMetal.of(material, prescribed)
            strains[body.name] = BodyStrains(mesh.bodies[body.name], metal)
        if COLD_CRACKS in fields and material.description.tensile_strength is not None:
            strength = Alloy(material).tensile_strength
            cold[body.name] = BodyColdCracks(mesh.bodies[body.name], strength, material.melts)
    return Cracks(strains, cold)


def deforming(case: Case) -> Iterator[tuple[Body, Material]]:
    """Yield the bodies that deform, with their materials."""
    for body in case.bodies:
        if body.law != "rigid":
            yield body, find_material(body.material, case.materials)
