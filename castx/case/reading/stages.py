"""Checks of the stages of a case against its bodies and surfaces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from castx.case.boundaries import CONDITIONS
from castx.case.case import Case
from castx.case.reading.between_parts import direction_problems
from castx.case.reading.contact import load_problems
from castx.case.stages import Stage
from castx.input.problems import KeyPath, Problem, among


def stage_problems(case: Case) -> Iterator[Problem]:
    """Yield all contradictions of the stages, each with the bodies present at its time."""
    present = [body.name for body in case.bodies]
    for index, stage in enumerate(case.stages):
        yield from _time_problems(case, index, stage)
        yield from _body_problems(case, index, stage, present)
        present = [name for name in present if name not in stage.remove]
        if stage.remove and not present:
            yield Problem(("stages", index, "remove"), "leaves no body; keep one at least")
            return
        yield from _surface_problems(case, index, stage, present)


def _time_problems(case: Case, index: int, stage: Stage) -> Iterator[Problem]:
    place, last = ("stages", index), len(case.stages) - 1
    if index > 0 and stage.at <= case.stages[index - 1].at:
        before = case.stages[index - 1].at
        yield Problem((*place, "at"), f"must be later than the stage before it, at {before:g} s")
    end = case.time.end
    if stage.acts and stage.at >= end:
        text = (
            f"begins when the case ends already (time.end, {end:g} s); make that later, or leave "
            "the stage out"
        )
        yield Problem((*place, "at"), text)
    elif stage.at > end:
        text = f"the cycle would end after the case does (time.end, {end:g} s); make that later"
        yield Problem((*place, "at"), text)
    if stage.repeat is not None and index < last:
        yield Problem((*place, "repeat"), "only the last stage can ask for cycles")


def _body_problems(
    case: Case, index: int, stage: Stage, present: Sequence[str]
) -> Iterator[Problem]:
    """Yield names of bodies that are unknown or absent.

    Args:
        case: the case.
        index: number of the stage.
        stage: the stage.
        present: names of the bodies before it.
    """
    names, place = [body.name for body in case.bodies], ("stages", index)
    for key in ("remove", "renew"):
        for number, name in enumerate(getattr(stage, key)):
            if name not in names:
                yield Problem((*place, key, number), f"unknown body; {among(name, names)}")
            elif key == "remove" and name not in present:
                text = f"is gone already; {among('', present, what='still there')}"
                yield Problem((*place, key, number), text)
        if key == "renew":
            yield from _renewal_problems(case, (*place, "renew"), stage.renew)
    if stage.eject is not None and case.coupling.scheme == "thermal":
        text = 'needs contact forces, which coupling.scheme = "thermal" does not have'
        yield Problem((*place, "eject"), text)
        return
    for name in stage.friction if isinstance(stage.eject, dict) else ():
        if name not in present:
            text = f"no such body at this time; {among(name, present, what='there are')}"
            yield Problem((*place, "eject", name), text)
        elif not _touched(case, name, present):
            text = f"{name!r} has no interface with contact; nothing holds it"
            yield Problem((*place, "eject", name), text)


def _renewal_problems(case: Case, place: KeyPath, renewed: Sequence[str]) -> Iterator[Problem]:
    for interface in case.interfaces:
        new = [name for name in interface.bodies if name in renewed]
        if interface.contact.method == "tied" and len(new) == 1:
            (old,) = set(interface.bodies) - set(new)
            text = f"{new[0]!r} is tied to {old!r}, which keeps its shape; renew both"
            yield Problem(place, f"{text}, or use another contact method")


def _touched(case: Case, body: str, present: Sequence[str]) -> bool:
    return any(
        body in interface.bodies
        and interface.contact.method != "none"
        and set(interface.bodies) <= set(present)
        for interface in case.interfaces
    )


def _surface_problems(
    case: Case, index: int, stage: Stage, present: Sequence[str]
) -> Iterator[Problem]:
    seen: set[tuple[str, str]] = set()
    for number, boundary in enumerate(stage.boundaries):
        place = ("stages", index, "boundaries", number)
        yield from _missing(case, (*place, "on"), boundary.on, present)
        yield from direction_problems(case, place, boundary)
        if case.coupling.scheme != "thermal":
            yield from load_problems(case, place, boundary)
        for key in CONDITIONS:
            if getattr(boundary, key) and (boundary.on, key) in seen:
                text = f"{boundary.on!r} has it already in this stage; put both in one entry"
                yield Problem((*place, key), text)
            elif getattr(boundary, key):
                seen.add((boundary.on, key))
    for number, name in enumerate(stage.spray.on if stage.spray is not None else ()):
        spot = ("stages", index, "spray", "on", number)
        if (name, "heat") in seen:
            yield Problem(spot, "boundaries of this stage give it heat already; leave out one")
        elif "/" in name:
            yield from _missing(case, spot, name, present)
        elif name not in present:
            yield Problem(spot, f"no such body then; {among(name, present, what='there are')}")


def _missing(case: Case, place: KeyPath, on: str, present: Sequence[str]) -> Iterator[Problem]:
    """Yield the name of a surface that is unknown, absent or covered."""
    body, _, surface = on.partition("/")
    names = [item.name for item in case.bodies]
    if body not in present:
        gone = "is removed by then" if body in names else "is unknown"
        text = f"the body {body!r} {gone}; {among(body, present, what='there are')}"
        yield Problem(place, text)
    elif surface in present:
        if any({body, surface} == set(interface.bodies) for interface in case.interfaces):
            text = f"{surface!r} still touches {body!r} there; remove it, or change the interface"
            yield Problem(place, text)
    elif case.geometry.surfaces is not None and surface not in names:
        known = [*case.geometry.surfaces.get(body, ()), *(n for n in names if n not in present)]
        if surface not in known:
            text = f"no surface {surface!r}; {among(surface, known, what=f'{body!r} has')}"
            yield Problem(place, text)
