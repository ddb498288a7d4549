"""Warnings of valid cases that may differ from the intention of their author."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from castx.case.bodies import Body
from castx.case.case import Case
from castx.input.variation import Variation
from castx.materials.granular import GRANULAR
from castx.materials.lookup import find_material
from castx.materials.material import Material

THINNEST_GAS = 1e-3
"""Conductivity below which no gas of a casting lies; freons and xenon have some 0.006 [W/m/K]."""
COLD = 250.0
"""A table of mean expansions that begins below this may be a handbook's, counted from 20 °C."""


def caveats(case: Case) -> Iterator[str]:
    """Yield a warning for each thing that gives another answer than its author may expect."""
    yield from _shut_gaps(case)
    yield from _gaps_without_gas(case)
    if case.coupling.scheme != "thermal":
        for name in dict.fromkeys(body.material for body in case.bodies if body.law != "rigid"):
            yield from _expansion(find_material(name, case.materials))
        yield from _elastic_melts(case)
        yield from _without_law(case)
        for body in case.bodies:
            if body.law != "rigid":
                yield from _stress_free(body, find_material(body.material, case.materials))


def _shut_gaps(case: Case) -> Iterator[str]:
    """Yield interfaces whose law waits for a gap that no scheme without mechanics opens."""
    if case.coupling.scheme != "thermal":
        return
    for interface in case.interfaces:
        heat = interface.heat
        if heat is not None and heat.declared.follows_gap and not _is_given_anyway(heat.closed):
            yield (
                f'interface {interface.name}: with scheme = "thermal" nothing moves, so that the '
                f'gap keeps its initial value and law = "{heat.law}" stays as it is there; use '
                'scheme = "iterated", or law = "solid-fraction" or coefficients over time or '
                "temperature"
            )


def _is_given_anyway(closed: Variation | None) -> bool:
    """Return whether a coefficient falls by time or temperature, whatever the gap does."""
    return closed is not None and not closed.is_constant and closed.over in ("time", "temperature")


def _gaps_without_gas(case: Case) -> Iterator[str]:
    """Yield interfaces in whose gap hardly anything conducts, so that they are open or shut."""
    for interface in case.interfaces:
        heat = interface.heat
        if heat is None or heat.gas_conductivity is None:
            continue
        least = float(heat.gas_conductivity.table.values.min())
        if least < THINNEST_GAS:
            yield (
                f"interface {interface.name}: gas_conductivity is {least:g} W/m/K, where air has "
                "0.026 and argon 0.018: a gap of a micrometre then stops all heat, so that pairs "
                "open and shut by turns and steps are cut; take that of the gas, and for a gap "
                'that shall insulate heat = { law = "none" } or "constant" with a coefficient '
                "over the gap"
            )


def _expansion(material: Material) -> Iterator[str]:
    """Yield a table of mean expansions that is counted from where a casting is free of stress."""
    table, reference = material.expansion, material.expansion_reference
    if table is None or reference is not None or not material.melts:
        return
    if table.arguments[0] < COLD and table.values[0] < table.values[-1]:
        yield (
            f"{material.name}: expansion is a table of mean values without expansion_reference, "
            "and so counts from the stress-free temperature; if it counts from room temperature, "
            "as in handbooks, give expansion_reference = 20, else it contracts too little"
        )


def _elastic_melts(case: Case) -> Iterator[str]:
    """Yield the bodies that start molten and have the law of a solid."""
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        molten = not body.starts_solid(material.description)
        if body.law != "rigid" and molten and material.liquid is None:
            yield (
                f"{body.name} starts molten, but {body.material} has no liquid, so that its melt "
                "is elastic: it leaves the wall at once and presses on cores and dies by tens of "
                "MPa; give the material a liquid (viscosity and coherency), or take an alloy of "
                "the database with its own"
            )


def _without_law(case: Case) -> Iterator[str]:
    """Yield bodies that freeze or are of sand, and elastic since nothing says their law."""
    for body in case.bodies:
        if "law" in body.model_fields_set:
            continue
        material = find_material(body.material, case.materials)
        if material.description.granular is not None:
            yield (
                f"{body.name} of {body.material} has no law and therefore is elastic: it neither "
                "crushes nor lets go of a casting that contracts, whose stress is too large; give "
                f'it law = "{GRANULAR}" (yields, and takes some times as long) or "rigid" (holds '
                'the casting until it is taken out), or write law = "thermo-elastic" if that is '
                "meant"
            )
        elif not body.starts_solid(material.description):
            yield (
                f"{body.name} has no law and therefore is elastic: it cannot yield, so that the "
                "report's residual stress, forces on mould and cores, and distortion after "
                'release are false; give it law = "thermo-elasto-viscoplastic" (castx materials '
                f'{body.material} shows whether it has the data), or write law = "thermo-elastic" '
                "if that is meant"
            )


def shut_in(case: Case, free: Mapping[str, float]) -> Iterator[str]:
    """Yield bodies that swell as they freeze, within rigid walls on all sides.

    Args:
        case: the case.
        free: area of the faces of each body that no other body shares [m²].
    """
    rigid = set(case.rigid_bodies)
    around: dict[str, list[str]] = {}
    for interface in case.interfaces:
        first, second = interface.bodies
        around.setdefault(first, []).append(second)
        around.setdefault(second, []).append(first)
    for body in case.bodies if case.coupling.scheme != "thermal" else ():
        material = find_material(body.material, case.materials)
        swells = (material.description.solidification_shrinkage or 0.0) < 0.0
        molten = body.law != "rigid" and not body.starts_solid(material.description)
        held = body.name in around and rigid.issuperset(around[body.name])
        if swells and molten and held and not free.get(body.name):
            yield (
                f"{body.name} of {body.material} swells as it freezes, and rigid bodies hold it on "
                "all sides: its pressure has no bound, and strain and stress that follow are "
                "false; leave it a free surface, such as that of a feeder (castx new --top open), "
                f'or give the mould a law that yields (sand: "{GRANULAR}")'
            )


def _stress_free(body: Body, material: Material) -> Iterator[str]:
    """Yield a warning of a stress-free temperature that does not suit the start of a body."""
    given, solidus = material.given_stress_free, material.solidus
    if given is None or solidus is None:
        return
    if body.starts_solid(material.description):
        if given >= solidus:
            yield (
                f"{body.name} starts solid at {body.temperature.text}, but {body.material} says "
                f"stress_free = {given:g} °C, so that it is strained from the first step on; for "
                "a mould, a core or a chill leave stress_free out: it is free of stress as it "
                "starts"
            )
    elif given < solidus and body.temperature.bounds is not None:
        yield (
            f"{body.name} starts at {body.temperature.text} and freezes, but {body.material} says "
            f"stress_free = {given:g} °C: it contracts only below that; leave stress_free out, or "
            "give the chill that needs it a material of its own"
        )
