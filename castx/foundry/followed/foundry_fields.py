"""Fields of the foundry in a run: those of the thermal history, and what follows from it by alloy.

Each is computed in every node from what `castx.foundry.front.solidification` notes there and the
data of the alloy; bodies that start solid, moulds and chills, have none of the latter.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from castx.arrays import FloatArray
from castx.case.bodies import Body
from castx.case.case import Case
from castx.case.fields.motion import DEVIATION
from castx.foundry.alloy import Alloy
from castx.foundry.arm_spacing import yield_strength
from castx.foundry.cracking import brittle_strain_ratio
from castx.foundry.followed.histories import NODAL, OF_MELTING, Histories
from castx.foundry.front.solidification import (
    QUANTITIES,
    BodySolidification,
    Followed,
    Solidification,
)
from castx.foundry.hot_tearing import BRIDGED, RELAXED, VULNERABLE, clyne_davies
from castx.foundry.modulus import PouredMetal, SandMould, mould_constant, thermal_modulus
from castx.foundry.pools.feeding_path import FEEDING_PATH
from castx.foundry.pools.hot_spots import POOL, HotSpots
from castx.foundry.porosity import dimensionless_niyama, pore_fraction
from castx.foundry.stress.cracks import BRITTLE, COLD_CRACKS, MARGIN, Cracks
from castx.foundry.stress.stage_ends import StageEnds
from castx.foundry.stress.strains import BodyStrains
from castx.foundry.suction import (
    CUT_OFFS,
    TEARING_DEPRESSION,
    MushSuction,
    rate_across,
    tearing_margin,
)
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.results.states.quantities import MARGINS, PASSING

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh


@dataclass(frozen=True, eq=False)
class Poured:
    """A body that freezes, as the quantities of the foundry see it.

    Attributes:
        alloy: its material.
        constant: of Chvorinov [s/m²]; None: nothing asks for it.
    """

    alloy: Alloy
    constant: float | None = None


Derived = Callable[[BodySolidification, Poured], FloatArray]


def _arm_spacing(history: BodySolidification, poured: Poured) -> FloatArray:
    return poured.alloy.spacing(history.cooling_rate())


def _dimensionless_niyama(history: BodySolidification, poured: Poured) -> FloatArray:
    alloy, rate = poured.alloy, history.cooling_rate()
    width = alloy.path.freezing_range
    return dimensionless_niyama(history.gradient(), rate, alloy.spacing(rate), alloy.melt(), width)


def _pore_fraction(history: BodySolidification, poured: Poured) -> FloatArray:
    critical = poured.alloy.critical_liquid(_dimensionless_niyama(history, poured))
    return pore_fraction(critical, poured.alloy.shrinkage)


def _clyne_davies(history: BodySolidification, poured: Poured) -> FloatArray:
    relief, vulnerable = history.lasted()
    return clyne_davies(np.zeros_like(relief), relief, relief + vulnerable)


def _yield_strength(history: BodySolidification, poured: Poured) -> FloatArray:
    strength = poured.alloy.strength
    return yield_strength(_arm_spacing(history, poured), strength.base, strength.slope)


def _modulus(history: BodySolidification, poured: Poured) -> FloatArray:
    assert poured.constant is not None
    return thermal_modulus(history.passing_time(1.0), poured.constant)


DERIVED: Mapping[str, Derived] = {
    "arm_spacing": _arm_spacing,
    "dimensionless_niyama": _dimensionless_niyama,
    "pore_fraction": _pore_fraction,
    "clyne_davies": _clyne_davies,
    "yield_strength": _yield_strength,
    "modulus": _modulus,
}


def brittle_field(strains: BodyStrains, poured: Poured, name: str) -> FloatArray:
    """Return the field of a name in `BRITTLE` at the nodes."""
    if name == "brittle_time":
        return strains.duration(BRIDGED)
    strain = strains.largest(BRIDGED)
    if name == "brittle_strain":
        return strain
    return brittle_strain_ratio(strain, poured.alloy.critical_strain)


def margin(
    strains: BodyStrains, history: BodySolidification, poured: Poured, cut_off: float
) -> FloatArray:
    """Return ε̇_⟂/ε̇_c of Rappaz, Drezet and Gremaud at the nodes, (nodes,); collective.

    Args:
        strains: gained in the mush, without those that shrinkage alone makes.
        history: gradient, front speed and cooling rate.
        poured: the alloy.
        cut_off: liquid fraction g_c.
    """
    alloy, until = poured.alloy, 1.0 - cut_off
    rate = rate_across(strains.largest_beside_shrinkage(until), strains.duration(until))
    front = history.gradient(), history.front_speed(), alloy.spacing(history.cooling_rate())
    melt = alloy.melt(TEARING_DEPRESSION)
    return tearing_margin(rate, MushSuction.of(alloy.path, cut_off).critical_rate(*front, melt))


def is_of_foundry(name: str) -> bool:
    """Return whether a field of the nodes is one of the foundry."""
    return name == POOL or name in BRITTLE or name in OF_MELTING or follows_fronts(name)


def follows_fronts(name: str) -> bool:
    """Return whether a field follows from when surfaces of solid fraction pass the nodes."""
    known = name in QUANTITIES or name in DERIVED or name == FEEDING_PATH
    return known or name.startswith((PASSING, MARGINS))


def pores_of(solidification: Solidification, poured: Mapping[str, Poured], body: str) -> FloatArray:
    """Return the pore fraction of the nodes of a body that freezes, (nodes,); collective."""
    history = solidification.of(body)
    assert history is not None
    return _pore_fraction(history, poured[body])


def written_names(name: str, case: Case) -> list[str]:
    """Return the fields that an entry of `output.fields` stands for."""
    if name == MARGIN:
        return [f"{MARGINS}{cut_off!r}" for cut_off in CUT_OFFS]
    if name != "passing_times":
        return [name]
    return [f"{PASSING}{fraction!r}" for fraction in case.foundry.passing_times]


def entry_of(name: str) -> str:
    """Return the entry of `output.fields` to which a written field belongs."""
    if name.startswith(PASSING):
        return "passing_times"
    return MARGIN if name.startswith(MARGINS) else name


class FoundryFields:
    """The fields of the foundry of all bodies.

    Args:
        solidification: the thermal history, followed elsewhere.
        poured: the bodies that freeze, by name.
        pools: their pools of liquid, followed elsewhere; None: nothing asks for them.
        ends: knows the distortion of the bodies that deform; None: nothing asks for it.
        cracks: strain and stress of the cooling, followed elsewhere; None: nothing asks for them.
        histories: what else is followed; None: nothing asks for it.
    """

    def __init__(
        self,
        solidification: Solidification,
        poured: Mapping[str, Poured],
        pools: HotSpots | None = None,
        ends: StageEnds | None = None,
        cracks: Cracks | None = None,
        histories: Histories | None = None,
    ) -> None:
        self._ends, self._histories = ends, histories
        self._cracks = Cracks({}, {}) if cracks is None else cracks
        self._solidification, self._poured, self._pools = solidification, poured, pools

    def nodal(self, body: str, name: str) -> FloatArray:
        """Return a field at the nodes of a body, ghosts included: (nodes,); collective.

        Not a number where it does not exist yet, and in bodies to which it does not apply.
        """
        if name == POOL:
            numbers = None if self._pools is None else self._pools.numbers(body)
            return self._solidification.nowhere(body) if numbers is None else numbers
        if name == DEVIATION:
            found = None if self._ends is None else self._ends.deviation(body)
            return self._solidification.nowhere(body) if found is None else found
        if name in BRITTLE:
            strains = self._cracks.strains(body)
            if strains is None:
                return self._solidification.nowhere(body)
            return brittle_field(strains, self._poured[body], name)
        if name in NODAL:
            found = None if self._histories is None else self._histories.field(body, name)
            return self._solidification.nowhere(body) if found is None else found
        history = self._solidification.of(body)
        if name in QUANTITIES or history is None:
            return self._solidification.nodal(body, name)
        if name.startswith(PASSING):
            return history.passing_time(float(name.removeprefix(PASSING)))
        if body not in self._poured:
            return self._solidification.nowhere(body)
        if name.startswith(MARGINS):
            strains = self._cracks.strains(body)
            if strains is None:
                return self._solidification.nowhere(body)
            cut_off = float(name.removeprefix(MARGINS))
            return margin(strains, history, self._poured[body], cut_off)
        return DERIVED[name](history, self._poured[body])

    def cellwise(self, body: str, name: str) -> FloatArray:
        """Return a field in the cells of a body: (cells,) or (cells, gdim), ghosts may follow.

        Not a number where it does not exist: the cold-crack index in cells that are not solid and
        in bodies without a tensile strength, the life of bodies that freeze.
        """
        if name == COLD_CRACKS:
            found = self._cracks.cold_crack_index(body)
        else:
            found = None if self._histories is None else self._histories.field(body, name)
        return self._solidification.nowhere_in_cells(body) if found is None else found


def followed_by(case: Case) -> Followed:
    """Return the surfaces whose passing the wanted fields ask for."""
    fractions: list[float] = []
    if "passing_times" in case.output.fields:
        fractions += case.foundry.passing_times
    lasting = (RELAXED, VULNERABLE, BRIDGED) if "clyne_davies" in case.output.fields else ()
    return Followed(case.foundry.at, tuple(fractions), lasting)


def solidification_of(case: Case, mesh: CastingMesh) -> Solidification:
    """Return the solidification of the bodies that melt, of none if no field needs it."""
    curves = {}
    names = [name for entry in case.output.fields for name in written_names(entry, case)]
    heated = case.coupling.scheme != "mechanical" or "fields" in case.output.model_fields_set
    if heated and any(follows_fronts(name) for name in names):
        for body in case.bodies:
            material = find_material(body.material, case.materials)
            if material.melts:
                curves[body.name] = material.enthalpy
    return Solidification(mesh, curves, followed_by(case))


def poured_bodies(case: Case) -> dict[str, Poured]:
    """Return the bodies that freeze in a run, by name."""
    found = {}
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        if not body.starts_solid(material.description):
            wanted = "modulus" in case.output.fields
            constant = chvorinov_constant(case, body, material) if wanted else None
            found[body.name] = Poured(Alloy(material), constant)
    return found


def chvorinov_constant(case: Case, body: Body, material: Material) -> float | None:
    """Return Chvorinov's constant of a casting, given or from its mould [s/m²]."""
    mould = case.foundry.modulus_mould
    if mould is None:
        return case.foundry.modulus_constant
    assert material.solidus is not None and material.liquidus is not None
    pouring = max(body.temperature.hottest, material.liquidus)
    capacity = material.heat_capacity.liquid.mean(material.liquidus, pouring)
    metal = PouredMetal(
        material.density * material.latent_heat,
        material.density * capacity,
        pouring,
        material.solidus,
        material.liquidus,
    )
    sand = find_material(mould.material, case.materials)
    middle = 0.5 * (material.solidus + material.liquidus)
    return mould_constant(
        metal,
        SandMould(
            sand.conductivity.solid.mean(mould.temperature, middle),
            sand.density * sand.heat_capacity.solid.mean(mould.temperature, middle),
            mould.temperature,
        ),
    )
