"""Check that bodies that freeze have the data for the requested foundry fields."""

from __future__ import annotations

from collections.abc import Iterator

from castx.case.bodies import DARCY, Body
from castx.case.case import Case
from castx.case.fields.heat import FLUX_ERROR
from castx.errors import CaseError
from castx.foundry.alloy import FEEDING, NEEDED, OF_THE_MUSH, missing
from castx.input.problems import Problem, Refusal, among
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.meshes.generators.declaration import PLANE_MODELS


def foundry_problems(case: Case) -> Iterator[Problem]:
    """Yield fields of the foundry that lack data, each with the key that it needs and the cure."""
    poured = list(_poured(case))
    for body, material in poured:
        yield from _field_problems(case, body, material)
        yield from _front_problems(case, body, material)
    if "modulus" in case.output.fields:
        yield from _modulus_problems(case, poured)
    if "cold_crack_index" in case.output.fields:
        yield from _strength_problems(case)
    if "tearing_margin" in case.output.fields and case.coupling.scheme == "mechanical":
        yield Problem(
            ("output", "fields", case.output.fields.index("tearing_margin")),
            "needs the gradient of the temperature and the speed of the front, which "
            'coupling.scheme = "mechanical" does not have; use another scheme, or leave it out',
        )
    if "suction_margin" in case.output.fields and not any(
        body.feeding == DARCY for body in case.bodies
    ):
        yield Problem(
            ("output", "fields", case.output.fields.index("suction_margin")),
            'needs the pressure in the mush, and no body has feeding = "darcy"; give it to a '
            "casting, take tearing_margin, or leave suction_margin out",
        )
    if "emptied" in case.output.fields and not any(case.loads.gravity):
        text = "missing; the field emptied needs to know what is up: gravity = [0, 0, -9.81]"
        yield Problem(("loads", "gravity"), text)
    for name in ("heat_flux", FLUX_ERROR):
        if name in case.output.fields and case.coupling.scheme == "mechanical":
            text = f'there is no {name} in a run with coupling.scheme = "mechanical"; leave it out'
            yield Problem(("output", "fields", case.output.fields.index(name)), text)
    yield from _form_problems(case)
    if "life" in case.output.fields:
        yield from _fatigue_problems(case)
    yield from _feeder_problems(case, [body.name for body, _ in poured])
    flowing = bool(poured) and all(body.feeding == DARCY for body, _ in poured)
    if flowing and case.foundry.mass_feeding_limit is not None:
        text = 'has no effect with feeding = "darcy": feeders sink by what they give; leave it out'
        yield Problem(("foundry", "mass_feeding_limit"), text)
    yield from _melt_flow_problems(case)


def _poured(case: Case) -> Iterator[tuple[Body, Material]]:
    """Yield the bodies that freeze, with their materials."""
    for body in case.bodies:
        try:
            material = find_material(body.material, case.materials)
        except (CaseError, Refusal):
            continue  # refused elsewhere
        if not body.starts_solid(material.description):
            yield body, material


def _field_problems(case: Case, body: Body, material: Material) -> Iterator[Problem]:
    for index, name in enumerate(case.output.fields):
        place = ("output", "fields", index)
        if name in OF_THE_MUSH and material.solidus == material.liquidus:
            yield Problem(
                place,
                f"material {material.name!r} of body {body.name!r} freezes at one temperature: a "
                f"material without a freezing range has no mush, and so no {name}; leave it out",
            )
        elif lacking := missing(material.description, NEEDED.get(name, ())):
            yield Problem(
                place,
                f"material {material.name!r} of body {body.name!r} has no {', '.join(lacking)}; "
                f"give it in [materials.{material.name}], or leave {name} out",
            )


def _front_problems(case: Case, body: Body, material: Material) -> Iterator[Problem]:
    temperature = case.foundry.at.temperature
    if temperature is None or material.solidus is None or material.liquidus is None:
        return
    if not material.solidus <= temperature <= material.liquidus:
        yield Problem(
            ("foundry", "at", "temperature"),
            f"body {body.name!r} freezes from {material.liquidus:g} to {material.solidus:g} °C; "
            "take a temperature between, or a solid fraction",
        )


def _feeder_problems(case: Case, freezing: list[str]) -> Iterator[Problem]:
    for index, on in enumerate(case.foundry.feeders or ()):
        body, _, _ = on.partition("/")
        if body not in freezing:
            text = f"no body {body!r} that freezes; {among(body, freezing)}"
            yield Problem(("foundry", "feeders", index), text)


def _melt_flow_problems(case: Case) -> Iterator[Problem]:
    """Yield bodies whose melt cannot flow through the mush."""
    for index, body in enumerate(case.bodies):
        if body.feeding != DARCY:
            continue
        place = ("bodies", index, "feeding")
        if body.law == "rigid" or case.coupling.scheme == "thermal":
            yield Problem(place, '"darcy" acts only in a body that deforms; leave it out')
            continue
        try:
            material = find_material(body.material, case.materials)
        except (CaseError, Refusal):
            continue  # refused elsewhere
        lacking = missing(material.description, FEEDING)
        if not material.melts or material.is_isothermal:
            text = f"material {material.name!r} has no freezing range, and so no mush"
            yield Problem(place, f'{text}; take feeding = "pockets"')
        elif lacking:
            text = f'"darcy" needs {", ".join(lacking)}; give it in [materials.{material.name}]'
            yield Problem(place, f'{text}, or take feeding = "pockets"')


def _strength_problems(case: Case) -> Iterator[Problem]:
    """Yield a problem if no body that deforms has a tensile strength."""
    for body in case.bodies:
        try:
            material = find_material(body.material, case.materials)
        except (CaseError, Refusal):
            return  # refused elsewhere
        if body.law != "rigid" and not missing(material.description, ("tensile_strength",)):
            return
    place = ("output", "fields", case.output.fields.index("cold_crack_index"))
    text = "no body that deforms has a tensile_strength; give it in its material"
    yield Problem(place, f"{text}, or leave cold_crack_index out")


def _form_problems(case: Case) -> Iterator[Problem]:
    """Yield selected surfaces of bodies that do not deform, and round ones of other models."""
    bodies = [body.name for body in case.bodies if body.law != "rigid"]
    bodies = [] if case.coupling.scheme == "thermal" else bodies
    for key in ("flat", "round"):
        for index, on in enumerate(getattr(case.foundry, key)):
            body, _, _ = on.partition("/")
            if body not in bodies:
                text = f"no body {body!r} that deforms; {among(body, bodies)}"
                yield Problem(("foundry", key, index), text)
    if case.foundry.round and case.geometry.model not in PLANE_MODELS:
        text = f"is known of sections, in plane models, not in the model {case.geometry.model!r}"
        yield Problem(("foundry", "round"), text)


def _fatigue_problems(case: Case) -> Iterator[Problem]:
    """Yield a problem if no body that deforms and does not freeze has a strain-life curve."""
    poured, lacking = {body.name for body, _ in _poured(case)}, []
    for body in case.bodies:
        try:
            material = find_material(body.material, case.materials)
        except (CaseError, Refusal):
            return  # refused elsewhere
        if body.law == "rigid" or body.name in poured:
            continue
        if not missing(material.description, ("fatigue",)):
            return
        lacking.append(material.name)
    place = ("output", "fields", case.output.fields.index("life"))
    text = "no body that deforms without freezing has fatigue"
    if lacking:
        text += f"; material {lacking[0]!r} needs fatigue = {{ strength, strength_exponent, "
        text += "ductility, ductility_exponent }"
    yield Problem(place, f"{text}, or leave life out")


def _modulus_problems(case: Case, poured: list[tuple[Body, Material]]) -> Iterator[Problem]:
    mould = case.foundry.modulus_mould
    if mould is None:
        if case.foundry.modulus_constant is None:
            cure = "or modulus_mould = { material, temperature }"
            text = f"missing; the field modulus needs it, {cure}"
            yield Problem(("foundry", "modulus_constant"), text)
        return
    place = ("foundry", "modulus_mould")
    try:
        material = find_material(mould.material, case.materials)
        material.require(("density", "heat_capacity", "conductivity"), "Chvorinov's constant")
    except (CaseError, Refusal) as error:
        yield Problem((*place, "material"), str(error))
    for body, cast in poured:
        if cast.solidus is not None and mould.temperature >= cast.solidus:
            text = f"must lie below the solidus of {body.name!r}, {cast.solidus:g} °C"
            yield Problem((*place, "temperature"), text)
