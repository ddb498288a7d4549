"""Warnings of temperatures outside the range for which the data of a material are valid.

Outside its range a table continues with its last value. `castx check` compares the ranges with the
temperatures named in the case and those that bodies may reach by contact with hotter ones, a run
with the temperatures that occur, once for each material and at the end.

Nodes of coarse sand beside a casting fall below all temperatures of a case, by 7 K at worst in a
mould at 20 °C round iron: tetrahedra with obtuse angles conduct from cold to hot there. No sand is
as cold, and no data are wanted for it, so that a run asks for none below what can be.
"""

from __future__ import annotations

import logging
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Self

from mpi4py import MPI

import numpy as np

from castx.case.bodies import Body
from castx.case.boundaries import HeatCondition
from castx.case.case import Case
from castx.command.watches.contact_temperature import contact_temperature
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


@dataclass
class LeftRange:
    """How far a material was outside the ranges of its data, and for how long.

    Attributes:
        time: during which some node of it was [s].
        distance: of the farthest temperature [K].
        share: largest one of the nodes of a body.
        body: that was outside farthest.
    """

    time: float = 0.0
    distance: float = 0.0
    share: float = 0.0
    body: str = ""

    def note(self, body: str, found: Sequence[OutsideRange], share: float) -> None:
        """Take over the state of a body after a step."""
        distance = max(item.beyond() for item in found)
        if distance > self.distance:
            self.distance, self.body = distance, body
        self.share = max(self.share, share)

    @property
    def text(self) -> str:
        """Time, largest distance and share in words."""
        share = 100.0 * self.share
        most = f"{share:.2g} %" if share >= 0.1 else "0.1 %"
        return (
            f"for {seconds_text(self.time, 2)}, by {self.distance:.2g} K at most (in {self.body}), "
            f"in no more than {most} of the nodes of a body at a time"
        )


class RangeWatch:
    """Warns once for each material when its temperature leaves the range of a property in use.

    At the end it says for how long, how far and where that was.

    Args:
        case: what is run.
        comm: ranks of the run; the first one warns.
    """

    def __init__(self, case: Case, comm: MPI.Intracomm) -> None:
        self._case, self._comm = case, comm
        self._materials = {
            body.material: find_material(body.material, case.materials) for body in case.bodies
        }
        self._left: dict[str, LeftRange] = {}
        self._coldest, self._time = coldest_possible(case), 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for material, left in self._left.items() if self._comm.rank == 0 else ():
            _log.warning("%s has left its data %s", material, left.text)

    def check(self, snapshot: Snapshot) -> None:
        """Compare the temperatures after an accepted step with the ranges; collective."""
        passed, self._time = max(snapshot.time - self._time, 0.0), snapshot.time
        outside: set[str] = set()
        for body, (low, high) in zip(self._case.bodies, self._extremes(snapshot), strict=True):
            if body.name not in snapshot.mesh.bodies:
                continue
            near = max(NEAR, SHARE * (high - low))
            least = max(low, min(self._coldest, high))
            material = self._materials[body.material]
            found = outside_used_range(self._case, body, material, least, high, near)
            if not found:
                continue
            if body.material not in self._left:
                self._warn(f"at t = {seconds_text(snapshot.time)}", body, found, low, high)
            left = self._left.setdefault(body.material, LeftRange())
            left.time += 0.0 if body.material in outside else passed
            outside.add(body.material)
            left.note(body.name, found, self._share(snapshot, body, found))

    def _share(self, snapshot: Snapshot, body: Body, found: Sequence[OutsideRange]) -> float:
        """Return the share of the nodes of a body that is outside a range; collective."""
        hot = min((f.valid[1] for f in found if f.asked[1] > f.valid[1]), default=np.inf)
        cold = max((f.valid[0] for f in found if f.asked[0] < f.valid[0]), default=-np.inf)
        temperature = snapshot.nodal(body.name, "temperature")
        owned = snapshot.mesh.bodies[body.name].nodes.dofmap.index_map.size_local
        beyond = (temperature[:owned] > hot) | (temperature[:owned] < cold)
        both = np.array([np.count_nonzero(beyond), owned])
        self._comm.Allreduce(MPI.IN_PLACE, both, MPI.SUM)
        return float(both[0] / max(both[1], 1))

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
                "the last value is used (said once for each material, and at the end)",
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


def hottest(case: Case, body: Body, material: Material) -> float:
    """Return the highest temperature that a body may reach [°C], by an estimate.

    Metal that is poured, bodies with a source of heat and those of unknown temperature may reach
    all that the case names; others their own, those of all conditions, and that of thick bodies
    which touch.

    Args:
        case: the case.
        body: one of its bodies.
        material: of the body.
    """
    _, most = temperature_range(case)
    contact, bounds = contact_temperature(case, body), body.temperature.bounds
    unknown = bounds is None or body.heat_source is not None or body.temperature_history is not None
    if unknown or contact is None or body.is_poured(material):
        return most
    named = [float(t.values.max()) for heat in _heat_conditions(case) for t in heat.temperatures]
    named += [float(s.spray.ambient.values.max()) for s in case.stages if s.spray is not None]
    assert bounds is not None
    return min(max([bounds[1], contact, *named]), most)


def coldest_possible(case: Case) -> float:
    """Return the temperature below which nothing of a case can cool [°C].

    Heat flows from hot to cold, so that it is the lowest one that the case names, unless a surface
    or a source draws heat whatever the temperature is: then it is −inf.
    """
    if _has_fluxes(case) or any(least < 0.0 for least, _ in _sources(case)):
        return -np.inf
    return temperature_range(case)[0]


def hottest_possible(case: Case) -> float:
    """Return the temperature above which nothing of a case can get [°C].

    It is the highest one that the case names, or inf, as `coldest_possible` says. What metal
    dissipates as it yields is left out: it heats by less than a kelvin, and not what is hottest.
    """
    if _has_fluxes(case) or any(most > 0.0 for _, most in _sources(case)):
        return np.inf
    return temperature_range(case)[1]


def _has_fluxes(case: Case) -> bool:
    """Return whether a surface takes or gives heat whatever the temperature is."""
    return any(
        not (heat.temperatures or heat.declared.insulates) for heat in _heat_conditions(case)
    )


def _sources(case: Case) -> list[tuple[float, float]]:
    """Return the least and the largest value of each heat source [W/m³]."""
    tables = [body.heat_source for body in case.bodies if body.heat_source is not None]
    return [(float(table.values.min()), float(table.values.max())) for table in tables]


def _heat_conditions(case: Case) -> list[HeatCondition]:
    """Return the heat conditions of all surfaces in all stages."""
    later = [boundary for stage in case.stages for boundary in stage.boundaries]
    return [heat for boundary in (*case.boundaries, *later) for heat in boundary.heat]


def outside_used_range(
    case: Case, body: Body, material: Material, low: float, high: float, near: float = 0.0
) -> list[OutsideRange]:
    """Return the properties in use by a body that are not valid at all of some temperatures.

    Args:
        case: the case.
        body: one of its bodies.
        material: of the body.
        low: lowest temperature [°C].
        high: highest temperature [°C].
        near: by what temperatures may lie outside a range [K].
    """
    used = used_properties(case, body, material.description)
    return [
        item
        for item in material.outside_range(low, high, near)
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


def material_warnings(case: Case) -> Iterator[str]:
    """Yield warnings of materials whose data end within the temperatures that bodies may have."""
    low, high = temperature_range(case)
    for name, ranges, names in _out_of_range(case, reached=True):
        yield (
            f"{name} ({names}) has data for less than the temperatures of the case, {low:g} to "
            f"{high:g} °C: {ranges}; beyond, the last value is used, and a run says whether it "
            "gets there, how far and for how long"
        )


def material_remarks(case: Case) -> Iterator[str]:
    """Yield materials with less data than the case has temperatures, which hardly get there."""
    warned = {names for _, _, names in _out_of_range(case, reached=True)}
    for name, ranges, names in _out_of_range(case, reached=False):
        if names not in warned:
            yield (
                f"{name} ({names}) has less data than the case has temperatures: {ranges}; where "
                "it is thick, hot metal takes it no farther than that, and a run warns of cores "
                "and pins that get beyond"
            )


def _out_of_range(case: Case, reached: bool) -> Iterator[tuple[str, str, str]]:
    """Yield materials that leave their data, the ranges of these, and the bodies of each.

    Args:
        case: the case.
        reached: whether only what bodies may reach by contact counts.
    """
    low, high = temperature_range(case)
    bodies: dict[tuple[str, str], list[str]] = defaultdict(list)
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        most = hottest(case, body, material) if reached else high
        found = outside_used_range(case, body, material, min(low, most), most)
        if found:
            bodies[body.material, ranges_text(found)].append(body.name)
    for (name, ranges), of_it in bodies.items():
        yield name, ranges, ", ".join(of_it)
