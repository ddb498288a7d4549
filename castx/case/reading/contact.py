"""Checks of contact, loads and supports against the bodies and surfaces of a case."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from castx.case.boundaries import LOADS, Boundary
from castx.case.case import Case
from castx.case.contact import NONE, body_problem
from castx.case.interfaces import Interface
from castx.input.problems import KeyPath, Problem, among


def surface_problems(case: Case, place: KeyPath, body: str, surface: str) -> Iterator[Problem]:
    """Yield a body that the case does not have, or a surface that its generator does not make."""
    names = [known.name for known in case.bodies]
    surfaces = case.geometry.surfaces
    if body not in names:
        yield Problem(place, f"unknown body {body!r}; {among(body, names)}")
    elif surfaces is not None and body in surfaces:
        known = [*surfaces[body], *(name for name in surfaces if name != body)]
        if surface not in known:
            nearest = among(surface, known, what=f"surfaces of {body!r}")
            yield Problem(place, f"no surface {surface!r}; {nearest}")


def face_problems(case: Case, index: int, interface: Interface) -> Iterator[Problem]:
    """Yield contradictions of contact from node to face."""
    contact, place = interface.contact, ("interfaces", index)
    if contact.pairing != "node-to-face":
        return
    heat = interface.heat
    if heat is not None and "perfect" in [part.declared.exchange for part in heat.parts]:
        text = '"perfect" joins the nodes of matching meshes; from node to face use "constant"'
        yield Problem((*place, "heat", "law"), text)
    for side, body in enumerate(interface.bodies if contact.surfaces else ()):
        assert contact.surfaces is not None
        where = (*place, "contact", "surfaces", side)
        yield from surface_problems(case, where, body, contact.surfaces[side])


def rigid_problems(case: Case) -> Iterator[Problem]:
    """Yield contact, loads and supports that rigid bodies cannot have."""
    rigid = case.rigid_bodies
    if case.coupling.scheme == "thermal":
        return
    if rigid and len(rigid) == len(case.bodies):
        yield Problem(("coupling", "scheme"), 'all bodies are rigid; use "thermal"')
        return
    for index, interface in enumerate(case.interfaces):
        method, (secondary, primary) = interface.contact.method, interface.bodies
        problem = body_problem(method, secondary, primary, rigid)
        if problem and method != NONE:
            yield Problem(("interfaces", index, "contact", "method"), problem)
    for index, boundary in enumerate(case.boundaries):
        yield from load_problems(case, ("boundaries", index), boundary)
    yield from _gate_problems(case, rigid)


def load_problems(case: Case, place: KeyPath, boundary: Boundary) -> Iterator[Problem]:
    """Yield loads of a boundary on a rigid body, where they have no effect."""
    for key in LOADS:
        if boundary.body in case.rigid_bodies and getattr(boundary, key):
            text = f"body {boundary.body!r} is rigid and feels no load; leave it out"
            yield Problem((*place, key), text)


def _gate_problems(case: Case, rigid: Collection[str]) -> Iterator[Problem]:
    for index, name in enumerate(case.support.in_gate):
        body, _, surface = name.partition("/")
        place = ("support", "in_gate", index)
        yield from surface_problems(case, place, body, surface)
        if body in rigid:
            yield Problem(place, f"body {body!r} is rigid and cannot lose its place; leave it out")
