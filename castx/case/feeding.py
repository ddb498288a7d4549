"""How the melt of each casting is fed, in words, and what its mush lacks to let it flow."""

from __future__ import annotations

from collections.abc import Iterator

from castx.case.bodies import DARCY, Body
from castx.case.case import Case
from castx.foundry.alloy import FEEDING, missing
from castx.materials.lookup import find_material
from castx.materials.material import Material


def feeding_texts(case: Case) -> Iterator[str]:
    """Yield a line about each poured body whose liquid counts in its mechanics."""
    if case.coupling.scheme == "thermal":
        return
    for body in case.bodies:
        material = find_material(body.material, case.materials)
        solid = body.starts_solid(material.description)
        if material.liquid is not None and not solid and body.law != "rigid":
            yield _text(case, body, material)


def _text(case: Case, body: Body, material: Material) -> str:
    """Return the line about one body."""
    if body.feeding == DARCY:
        feeders = case.foundry.feeders
        named = [on for on in feeders or () if on.partition("/")[0] == body.name]
        by = "all free surfaces" if feeders is None else ", ".join(named) or "nothing"
        return f'{body.name}: melt flows through its mush (feeding = "darcy"), fed by {by}'
    pockets = f'{body.name}: trapped melt has one pressure in each pocket (feeding = "pockets")'
    lacking = missing(material.description, FEEDING)
    if material.is_isothermal:
        return (
            f"{pockets}; {material.name} freezes at one temperature and has no mush to flow through"
        )
    if lacking:
        keys = ", ".join(lacking)
        return f'{pockets}; for flow through the mush, "darcy", {material.name} lacks {keys}'
    return f'{pockets}; {material.name} has the data for flow through the mush, "darcy"'
