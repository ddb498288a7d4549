"""Warnings of temperatures outside the range for which the data of a material are valid.

Outside its range a table continues with its last value. `castx check` compares the ranges with the
temperatures named in the case, a run with the temperatures that occur, once for each material.

Nodes of coarse sand beside a casting fall below all temperatures of a case, by 7 K at worst in a
mould at 20 °C round iron: tetrahedra with obtuse angles conduct from cold to hot there. No sand is
as cold, and no data are wanted for it, so that a run asks for none below what can be.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence

from mpi4py import MPI

import numpy as np

from castx.case.bodies import Body
from castx.case.boundaries import HeatCondition
from castx.case.case import Case
from castx.input.units import seconds_text
from castx.materials.description import MaterialDescription
from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.materials.granular import GRANULAR
from castx.materials.inelastic import FLOW_RULES, KINEMATIC_KEYS
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.materials.sources import OutsideRange
from castx.results.states.snapshot import Snapshot

_log = logging.getLogger(__name__)

NEAR, SHARE = 0.5, 3e-3
"""By what temperatures may lie outside a range without a word [K], and as a share of what the
body spans: a step that chills a coarse mesh lets nodes beside it fall short by as much, and no
table knows its ends as well."""
_HEAT = {"heat_capacity", "conductivity"}
_ELASTIC = {"young_modulus", "poisson_ratio", "expansion"}
_HARDENING = {"yield_stress", "hardening", *KINEMATIC_KEYS}


class RangeWatch:
    """Warns once for each material when its temperature leaves the range of a property in use.

    Args:
        case: what is run.
        comm: ranks of the run; the first one warns.
    """

    def __init__(self, case: Case, comm: MPI.Intracomm) -> None:
        self._case, self._comm = case, comm
        self._materials = {
            body.material: find_material(body.material, case.materials) for body in case.bodies
        }
        self._warned: set[str] = set()
        self._coldest = coldest_possible(case)

    def check(self, snapshot: Snapshot) -> None:
        """Compare the temperatures after an accepted step with the ranges; collective."""
        if len(self._warned) == len(self._materials):
            return
        for body, (low, high) in zip(self._case.bodies, self._extremes(snapshot), strict=True):
            if body.material in self._warned or body.name not in snapshot.mesh.bodies:
                continue
            near = max(NEAR, SHARE * (high - low))
            least = max(low + near, min(self._coldest, high))
            within = least, max(high - near, least)
            found = outside_used_range(self._case, body, self._materials[body.material], *within)
            if found:
                self._warned.add(body.material)
                self._warn(f"at t = {seconds_text(snapshot.time)}", body, found, low, high)

    def _extremes(self, snapshot: Snapshot) -> Iterator[tuple[float, float]]:
        """Yield the lowest and the highest temperature of each body on all ranks [°C]."""
        own = np.full((len(self._case.bodies), 2), -np.inf)
        for row, body in zip(own, self._case.bodies, strict=True):
            if body.name not in snapshot.mesh.bodies:
                continue
            temperature = snapshot.nodal(body.name, "temperature")
            if temperature.size:
                row[:] = -temperature.min(), temperature.max()
        both = np.empty_like(own)
        self._comm.Allreduce(own, both, MPI.MAX)
        yield from ((-float(low), float(high)) for low, high in both)

    def _warn(
        self, when: str, body: Body, found: Sequence[OutsideRange], low: float, high: float
    ) -> None:
        if self._comm.rank == 0:
            _log.warning(
                "%s %s (%s) is at %.4g to %.4g °C, outside what its data hold for: %s; beyond, "
                "the last value is used (said once for each material)",
                when, body.material, body.name, low, high, ranges_text(found),
            )  # fmt: skip


def temperature_range(case: Case) -> tuple[float, float]:
    """Return the lowest and the highest temperature that a case names [°C]."""
    found = [bound for body in case.bodies for bound in body.temperature.bounds or ()]
    tables = [body.temperature_history for body in case.bodies]
    tables += [stage.spray.ambient for stage in case.stages if stage.spray is not None]
    for heat in _heat_conditions(case):
        for named in heat.temperatures:
            found += [float(named.values.min()), float(named.values.max())]
    for table in tables:
        if table is not None:
            found += [float(table.values.min()), float(table.values.max())]
    return min(found, default=20.0), max(found, default=20.0)


def coldest_possible(case: Case) -> float:
    """Return the temperature below which nothing of a case can cool [°C].

    Heat flows from hot to cold, so that it is the lowest one that the case names, unless a surface
    or a source draws heat whatever the temperature is: then it is −inf.
    """
    drawn = any(
        not (heat.temperatures or heat.declared.insulates) for heat in _heat_conditions(case)
    )
    sources = [body.heat_source for body in case.bodies if body.heat_source is not None]
    if drawn or any(float(source.values.min()) < 0.0 for source in sources):
        return -np.inf
    return temperature_range(case)[0]


def _heat_conditions(case: Case) -> list[HeatCondition]:
    """Return the heat conditions of all surfaces in all stages."""
    later = [boundary for stage in case.stages for boundary in stage.boundaries]
    return [heat for boundary in (*case.boundaries, *later) for heat in boundary.heat]


def outside_used_range(
    case: Case, body: Body, material: Material, low: float, high: float
) -> list[OutsideRange]:
    """Return the properties in use by a body that are not valid at all of some temperatures.

    Args:
        case: the case.
        body: one of its bodies.
        material: of the body.
        low: lowest temperature [°C].
        high: highest temperature [°C].
    """
    used = used_properties(case, body, material.description)
    return [
        item
        for item in material.outside_range(low, high)
        if item.property.partition(".")[0] in used
    ]


def ranges_text(found: Sequence[OutsideRange]) -> str:
    """Return in words which properties are valid in which range of temperature."""
    groups: dict[tuple[float, float], list[str]] = {}
    for item in found:
        groups.setdefault(item.valid, []).append(item.property)
    return ", ".join(
        f"{', '.join(names)} ({low:g} to {high:g} °C)" for (low, high), names in groups.items()
    )


def used_properties(case: Case, body: Body, material: MaterialDescription) -> set[str]:
    """Return the keys of the temperature-dependent properties in use by a body.

    Args:
        case: the case.
        body: one of its bodies.
        material: of the body.
    """
    scheme = case.coupling.scheme
    used = set() if scheme == "mechanical" else set(_HEAT)
    if scheme == "thermal" or body.law == "rigid":
        return used
    used |= _ELASTIC
    if body.formulation != "displacement" or not body.starts_solid(material):
        used.add("liquid")
    viscous, rule = body.law == VISCOPLASTIC, FLOW_RULES[material.law]
    if viscous:
        used |= {key.name for key in rule.keys}
    if body.law == GRANULAR:
        used.add("granular")
    if body.law == PLASTIC or (viscous and rule.threshold):
        used |= _HARDENING
    return used
