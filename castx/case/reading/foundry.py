"""Whether bodies that freeze have what the wanted fields of the foundry ask for."""

from __future__ import annotations

from collections.abc import Iterator

from castx.case.bodies import Body
from castx.case.case import Case
from castx.errors import CaseError
from castx.foundry.alloy import NEEDED, OF_THE_MUSH, missing
from castx.input.problems import Problem, Refusal, among
from castx.materials.lookup import find_material
from castx.materials.material import Material


def foundry_problems(case: Case) -> Iterator[Problem]:
    """Yield fields of the foundry that lack data, each with the key that it needs and the cure."""
    poured = list(_poured(case))
    for body, material in poured:
        yield from _field_problems(case, body, material)
        yield from _front_problems(case, body, material)
    if "modulus" in case.output.fields:
        yield from _modulus_problems(case, poured)
    yield from _feeder_problems(case, [body.name for body, _ in poured])


def _poured(case: Case) -> Iterator[tuple[Body, Material]]:
    """Yield the bodies that freeze, with their materials."""
    for body in case.bodies:
        try:
            material = find_material(body.material, case.materials)
        except (CaseError, Refusal):
            continue  # refused elsewhere
        if material.melts and not body.starts_solid(material.description):
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
