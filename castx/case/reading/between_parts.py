"""Checks between the parts of a case: names, materials, temperatures, surfaces, directions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from castx.case.bodies import DARCY, IN_CELLS, Body
from castx.case.boundaries import CONDITIONS, FRAME, FREE, FREE_CLAMP, Boundary, ClampCondition
from castx.case.case import Case
from castx.case.interfaces import Interface
from castx.case.reading.contact import face_problems, rigid_problems, surface_problems
from castx.case.reading.foundry import foundry_problems
from castx.case.reading.freezing import touches_perfectly
from castx.case.reading.step_tolerance import step_tolerance_problems
from castx.case.reading.taylor_hood import taylor_hood_problems
from castx.errors import CaseError
from castx.input.placed import NOW, PlacedFormula
from castx.input.problems import KeyPath, Problem, Refusal, among
from castx.materials.description import MaterialDescription
from castx.materials.flow import law_problems
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.meshes.model import SYMMETRY
from castx.tables import Table

MOST_MOMENTS = 10_000
"""States of the fields that a run may be asked for by a time between them."""
RIGID = 'law = "rigid", as sand may have, and to stand second in the bodies of its interfaces'


def case_problems(case: Case) -> Iterator[Problem]:
    """Yield all contradictions between the parts of a case but for its stages."""
    yield from _name_problems(case)
    yield from _material_problems(case)
    yield from _interface_problems(case)
    yield from rigid_problems(case)
    yield from taylor_hood_problems(case)
    yield from step_tolerance_problems(case)
    yield from _boundary_problems(case)
    yield from _gravity_problems(case)
    yield from _probe_problems(case)
    yield from _output_problems(case)
    yield from foundry_problems(case)


def _output_problems(case: Case) -> Iterator[Problem]:
    every = case.output.every
    if every is not None and case.time.end > MOST_MOMENTS * every:
        text = f"would write more than {MOST_MOMENTS:g} states until {case.time.end:g} s"
        shortest = case.time.end / MOST_MOMENTS
        yield Problem(("output", "every"), f"{text}; at least {shortest:.3g} s is needed")


def _name_problems(case: Case) -> Iterator[Problem]:
    for key in ("bodies", "probes"):
        seen: set[str] = set()
        for index, item in enumerate(getattr(case, key)):
            if item.name in seen:
                yield Problem((key, index, "name"), "is there already; names must differ")
            seen.add(item.name)
    known = case.geometry.surfaces
    for index, body in enumerate(case.bodies):
        if known is not None and body.name not in known:
            makes = among(body.name, list(known), what=f"{case.geometry.generator} makes")
            yield Problem(("bodies", index, "name"), f"no such body; {makes}")


def _material_problems(case: Case) -> Iterator[Problem]:
    descriptions: dict[str, MaterialDescription] = {}
    used = [body.material for body in case.bodies]
    for name in dict.fromkeys([*used, *case.materials]):
        try:
            material = find_material(name, case.materials)
            descriptions[name] = material.description
            yield from _enthalpy_problems(material)
        except Refusal as refusal:
            yield from refusal.problems
        except CaseError as error:
            for index in (index for index, material in enumerate(used) if material == name):
                yield Problem(("bodies", index, "material"), str(error))
    for index, body in enumerate(case.bodies):
        if body.material in descriptions:
            yield from _body_problems(case, index, body, descriptions[body.material])


def _enthalpy_problems(material: Material) -> Iterator[Problem]:
    """Yield an enthalpy that cannot be inverted."""
    if material.description.density is None or material.description.heat_capacity is None:
        return
    try:
        _ = material.enthalpy
    except CaseError as error:
        yield Problem(("materials", material.name, "heat_capacity"), str(error))


def _body_problems(
    case: Case, index: int, body: Body, material: MaterialDescription
) -> Iterator[Problem]:
    yield from _temperature_problems(case, index, body)
    scheme = case.coupling.scheme
    for key, purpose in _needed_properties(case, body, material):
        if getattr(material, key) is None:
            stated = body.material in case.materials
            path = ("materials", body.material, key) if stated else ("bodies", index, "material")
            text = "missing" if stated else f"has no {key}"
            yield Problem(path, f"{text}; body {body.name!r} needs it for {purpose}")
    if body.temperature_history is not None and scheme != "mechanical":
        text = f'prescribes the temperature, but coupling.scheme = "{scheme}" solves for it'
        cure = 'use scheme = "mechanical" or leave it out'
        yield Problem(("bodies", index, "temperature_history"), f"{text}; {cure}")
    if body.freezing == IN_CELLS:
        yield from _problems_of_freezing_in_cells(case, index, body, material)
    if scheme == "thermal":
        return
    for key, text in law_problems(material, body.law):
        stated = body.material in case.materials
        place = ("materials", body.material, key) if stated else ("bodies", index, "material")
        yield Problem(place, f"{key} is {text}; body {body.name!r} needs it for its law")
    if body.formulation == "displacement" and material.liquid is not None:
        if not body.starts_solid(material):
            text = f'material {body.material!r} has an incompressible liquid; use "mixed"'
            yield Problem(("bodies", index, "formulation"), f'{text}, or liquid = "none" there')


def _problems_of_freezing_in_cells(
    case: Case, index: int, body: Body, material: MaterialDescription
) -> Iterator[Problem]:
    """Yield metals without a solid fraction of its own at each temperature, and melt that flows.

    So are walls whose temperature jumps, see `touches_perfectly`.
    """
    place, cure = ("bodies", index, "freezing"), 'freezing = "nodes" has no such limit'
    metal = Material(body.material, material)
    if not metal.melts:
        yield Problem(place, f"{body.material!r} never freezes; leave it out")
    elif metal.plateaus:
        text = f'"cells" needs a solid fraction at each temperature, but {body.material!r} freezes'
        yield Problem(place, f"{text} at one temperature, if only in part; {cure}")
    if body.feeding == DARCY:
        yield Problem(place, f'melt that flows by feeding = "darcy" counts at nodes; {cure}')
    if touches_perfectly(case, body):
        text = 'the walls of perfect contact take one temperature at once, and with "cells" heat is'
        yield Problem(place, f"{text} lost by that; {cure}")


def _needed_properties(
    case: Case, body: Body, material: MaterialDescription
) -> Iterator[tuple[str, str]]:
    scheme = case.coupling.scheme
    if scheme != "mechanical":
        yield from ((key, "heat") for key in ("density", "heat_capacity", "conductivity"))
    if scheme == "thermal":
        return
    if body.law == "rigid":
        return
    purpose = f"mechanics, or {RIGID}"
    yield from ((key, purpose) for key in ("young_modulus", "poisson_ratio"))
    if scheme == "mechanical" and any(case.loads.gravity):
        yield "density", "gravity"
    constant = body.temperature_history is None and material.stress_free is None
    if scheme != "mechanical" or not constant or material.freezing_range is not None:
        yield "expansion", "its thermal strain"


def _axes_problems(case: Case, place: KeyPath, axes: Sequence[str]) -> Iterator[Problem]:
    """Yield coordinates along which something varies that the model does not have."""
    known = case.geometry.coordinates
    for axis in axes:
        if axis not in (*known, NOW):
            yield Problem(place, among("", known, what=f"not {axis}; coordinates of this model"))


def _temperature_problems(case: Case, index: int, body: Body) -> Iterator[Problem]:
    given, place = body.temperature, ("bodies", index, "temperature")
    key = "formula" if isinstance(given.placed, PlacedFormula) else "along"
    yield from _axes_problems(case, (*place, key), given.axes)
    if given.uniform is not None or given.is_missing:
        return
    if case.coupling.scheme == "mechanical":
        text = 'must be uniform with coupling.scheme = "mechanical", which solves no heat equation'
        yield Problem(place, text)


def _interface_problems(case: Case) -> Iterator[Problem]:
    names = [body.name for body in case.bodies]
    coordinates = case.geometry.coordinates
    seen: set[frozenset[str]] = set()
    for index, interface in enumerate(case.interfaces):
        place = ("interfaces", index)
        for side, name in enumerate(interface.bodies):
            if name not in names:
                yield Problem((*place, "bodies", side), f"unknown body; {among(name, names)}")
        pair = frozenset(interface.bodies)
        if len(pair) == 1:
            yield Problem((*place, "bodies"), "an interface needs two different bodies")
        elif pair in seen:
            yield Problem((*place, "bodies"), "these bodies have an interface already")
        seen.add(pair)
        gap = interface.contact.initial_gap
        if not gap.table.is_constant and gap.along not in coordinates:
            allowed = among("", coordinates, what="coordinates of this model")
            yield Problem((*place, "contact", "initial_gap", "along"), allowed)
        yield from _heat_problems(case, index, interface)
        yield from face_problems(case, index, interface)
        if interface.heat is None and case.coupling.scheme != "mechanical":
            yield Problem((*place, "heat"), 'missing; law = "none" lets no heat through')


def _heat_problems(case: Case, index: int, interface: Interface) -> Iterator[Problem]:
    heat, place = interface.heat, ("interfaces", index, "heat")
    if heat is None:
        return
    coordinates = case.geometry.coordinates
    for number, patch in enumerate(heat.patches):
        for axis in patch.within:
            if axis not in coordinates:
                allowed = among("", coordinates, what="coordinates of this model")
                yield Problem((*place, "patches", number, "within", axis), allowed)
    asked = any(part.declared.needs_solid_fraction for part in heat.parts)
    secondary = [body for body in case.bodies if body.name == interface.secondary]
    if asked and secondary and not _melts(case, secondary[0]):
        text = f"the solid fraction of {interface.secondary!r} does not change: it never melts"
        cure = "name the casting first in bodies, or take another law"
        yield Problem((*place, "law"), f"{text}; {cure}")


def _melts(case: Case, body: Body) -> bool:
    try:
        return find_material(body.material, case.materials).melts
    except CaseError:
        return True  # refused elsewhere


def _boundary_problems(case: Case) -> Iterator[Problem]:
    counts: Counter[tuple[str, str]] = Counter()
    for index, boundary in enumerate(case.boundaries):
        place = ("boundaries", index)
        yield from surface_problems(case, (*place, "on"), boundary.body, boundary.surface)
        for key in CONDITIONS:
            if getattr(boundary, key):
                counts[boundary.on, key] += 1
            if counts[boundary.on, key] > 1 and getattr(boundary, key):
                text = f"{boundary.on!r} has it already; put both in one entry"
                yield Problem((*place, key), text)
        free = {"displacement": FREE in boundary.displacement,
                "clamp": boundary.clamp is FREE_CLAMP}  # fmt: skip
        for key in (key for key, lifted in free.items() if lifted):
            text = "only a stage lifts what held a surface before; leave it out here"
            yield Problem((*place, key), text)
        yield from direction_problems(case, place, boundary)


def direction_problems(case: Case, place: KeyPath, boundary: Boundary) -> Iterator[Problem]:
    """Yield directions of a boundary that the model does not have."""
    allowed = case.geometry.directions
    for condition in boundary.displacement:
        if condition is not FREE and condition.direction not in allowed:
            known = among("", allowed, what=f"directions of the model {case.geometry.model!r}")
            yield Problem((*place, "displacement", condition.direction), known)
    loads = [("pressure", boundary.pressure), *(("traction", t) for t in boundary.traction or ())]
    for key, load in loads:
        if load is not None and not isinstance(load, Table):
            yield from _axes_problems(case, (*place, key), load.axes)
    if boundary.traction is not None and len(boundary.traction) != case.geometry.gdim:
        yield Problem((*place, "traction"), f"needs {case.geometry.gdim} components")
    if boundary.clamp is not None:
        yield from _clamp_problems(case, (*place, "clamp"), boundary.surface, boundary.clamp)


def _clamp_problems(
    case: Case, place: KeyPath, surface: str, clamp: ClampCondition
) -> Iterator[Problem]:
    axes = [axis for axis in ("x", "y", "z", FRAME) if axis in case.geometry.directions]
    if clamp.direction is not None and clamp.direction not in axes:
        known = among("", axes, what=f"a clamp in the model {case.geometry.model!r} may have")
        yield Problem((*place, "direction"), known)
    if surface.startswith(SYMMETRY):
        text = "the body goes on behind a symmetry plane, where no machine presses; leave it out"
        yield Problem(place, text)


def _gravity_problems(case: Case) -> Iterator[Problem]:
    gravity, model = case.loads.gravity, case.geometry.model
    place = ("loads", "gravity")
    if gravity and len(gravity) not in (3, case.geometry.gdim):
        yield Problem(place, f"needs {case.geometry.gdim} components in the model {model!r}")
    elif model == "axisymmetric" and any(gravity[:-1]):
        yield Problem(place, "must point along the axis in an axisymmetric model: [0, -9.81]")
    elif model not in ("3d", "axisymmetric") and any(gravity[2:]):
        yield Problem(place, "must lie in the plane of a plane model: [0, -9.81]")


def _probe_problems(case: Case) -> Iterator[Problem]:
    known = {
        "body": [body.name for body in case.bodies],
        "interface": [interface.name for interface in case.interfaces],
    }
    for index, probe in enumerate(case.probes):
        for key, names in known.items():
            name = getattr(probe, key)
            if name is not None and name not in names:
                yield Problem(("probes", index, key), f"unknown {key}; {among(name, names)}")
        if probe.below is not None and probe.body is not None:
            touching = [name for name in known["interface"] if probe.body in name.split("/")]
            if probe.below not in touching and not probe.below.startswith(f"{probe.body}/"):
                own = among(probe.below, [*touching, f"{probe.body}/SURFACE"])
                yield Problem(("probes", index, "below"), f"no surface of {probe.body!r}; {own}")
        if len(probe.at) != case.geometry.gdim:
            text = f"needs {case.geometry.gdim} coordinates in the model {case.geometry.model!r}"
            yield Problem(("probes", index, "at"), text)
