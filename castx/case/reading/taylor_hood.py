"""Checks of bodies with quadratic displacements: what touches, clamps and solves them."""

from __future__ import annotations

from collections.abc import Iterator

from castx.case.case import Case
from castx.case.contact import NONE
from castx.contact.methods.registry import DEFAULT, METHODS
from castx.input.problems import Problem

TAYLOR_HOOD = "taylor-hood"


def taylor_hood_problems(case: Case) -> Iterator[Problem]:
    """Yield contact, clamps and solvers that bodies with quadratic displacements cannot have."""
    quadratic = [body.name for body in case.bodies if body.formulation == TAYLOR_HOOD]
    if not quadratic or case.coupling.scheme == "thermal":
        return
    for index, interface in enumerate(case.interfaces):
        contact, place = interface.contact, ("interfaces", index, "contact")
        touching = [name for name in interface.bodies if name in quadratic]
        if not touching or contact.method == NONE:
            continue
        has = f"{touching[0]!r} has the formulation 'taylor-hood'"
        by_blocks = [name for name in METHODS if METHODS[name].by_blocks]
        for name in (contact.method, *contact.fallback):
            if name in by_blocks:
                key = "method" if name == contact.method else "fallback"
                text = f"{has}, which is not solved block by block; use {DEFAULT!r} in place of"
                yield Problem((*place, key), f"{text} {name!r}")
    for index, boundary in enumerate(case.boundaries):
        clamp = boundary.clamp
        if boundary.body in quadratic and clamp is not None and clamp.stiffness is not None:
            text = "a body with the formulation 'taylor-hood' takes a force, not a stiffness"
            yield Problem(("boundaries", index, "clamp", "stiffness"), text)
    if case.solver.linear == "iterative":
        text = f"{quadratic[0]!r} has the formulation 'taylor-hood', whose solver is chosen by size"
        yield Problem(("solver", "linear"), f'{text}; use "direct" or leave it out')
