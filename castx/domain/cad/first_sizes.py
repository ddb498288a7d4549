"""Sizes of cells at the interfaces of a first mesh: for skins, and for the heat of the mould."""

from __future__ import annotations

from dataclasses import replace

from scipy.optimize import brentq

from castx.case.cad.template import NewCase, case_text
from castx.case.processes.plan import rounded
from castx.case.reading.read import load_case
from castx.case.skin import MOST_GROWTH, millimetres, skins
from castx.case.soak import soaks
from castx.domain.cad.first_mesh import GROWN, GROWTH, Say
from castx.input.toml_text import parse_toml

EDGES = 1.3
"""What edges of interfaces and the changes between sizes add to the cells of plane layers."""
TETRAHEDRA = 6.7
"""Cells of a mesh over those of plane layers by the root of their growth: a plate of iron, 5 mm
thick, in sand has 6,200, 21,800 and 40,700 with 5.4, 2.5 and 1.9 mm, where these are 5,900, 24,100
and 41,600, and 44,300 with 1.5 mm and a growth of one, where they are 43,600."""
TALL = 1.4
"""Height of cells of a mould across its interface over their size there, 1.29 to 1.55 there."""
MOST_CELLS = 30_000
"""Cells up to which a first mesh is refined for the heat that its mould takes up."""


def with_interface_size(case: NewCase) -> NewCase:
    """Return a new case with cells that resolve its skins, if they have to be finer for that.

    The number of cells grows at most to `MOST_GROWTH` of what the largest size alone would make.
    """
    foreseen = skins(load_case(parse_toml(case_text(case))), _moduli(case))
    wanted = min((skin.proposal for skin in foreseen), default=case.size)
    size = max(wanted, _finest(case))
    return replace(case, interface_size=rounded(size)) if size < case.size else case


def with_soaked_cells(case: NewCase, text: str, say: Say) -> NewCase:
    """Return a new case with cells at interfaces that resolve the heat which a mould takes up.

    Else thin castings in sand freeze far too early. Where the cells became too many, those in the
    mould grow faster; where that does not do either, they are as fine as a first run can afford.

    Args:
        case: with sizes for the skins of its castings.
        text: of its case file, with process and materials.
        say: gets the reason of what changes.
    """
    found = list(soaks(load_case(parse_toml(text)), _moduli(case)))
    soak = min(found, key=lambda each: each.untold, default=None)
    if soak is None:
        return case
    size, now = soak.untold / TALL, case.interface_size or case.size
    if size >= now:
        return case
    why = f"{soak.mould} takes up the heat of freezing {millimetres(soak.depth)} deep"
    usual = case.growth or GROWTH
    for growth in sorted({usual, GROWN}):
        if _cells(case, size, growth) <= MOST_CELLS:
            say(f"cells of {millimetres(size)} at interfaces: {why}")
            grown = case.growth if growth == usual else growth
            return replace(case, interface_size=rounded(size), growth=grown)
    if _cells(case, now, GROWN) >= MOST_CELLS:
        return case
    many = 1e3 * float(f"{_cells(case, size, GROWN) / 1e3:.1g}")
    finest = float(brentq(lambda at: _cells(case, at, GROWN) - MOST_CELLS, size, now))
    say(
        f"cells of {millimetres(finest)} at interfaces, as fine as a first run can afford: {why}; "
        f"all of it is seen by {millimetres(size)}, some {many:.0f} cells"
    )
    return replace(case, interface_size=rounded(finest), growth=GROWN)


def _cells(case: NewCase, size: float, growth: float) -> float:
    """Return about how many cells a mesh has with a size at interfaces [m]."""
    fine = EDGES * _sides(case) * _layers(case, size) / growth**0.5
    return float(TETRAHEDRA * (_coarse_cells(case) + fine))


def _layers(case: NewCase, size: float) -> float:
    """Return cells of layers on an area that grow evenly from a size, over area and growth [1/m²].

    Those that the largest size would make are left out.
    """
    return 0.5 * (size**-2 - case.size**-2) - (case.size - size) / case.size**3


def _moduli(case: NewCase) -> dict[str, float]:
    """Return volume over surface of the bodies [m]."""
    return {body: case.modulus(body) for body, _ in case.bodies}


def _coarse_cells(case: NewCase) -> float:
    """Return cells of the largest size in all bodies."""
    return sum(volume for _, volume in case.bodies) / case.size**3


def _sides(case: NewCase) -> float:
    """Return the area of both sides of the interfaces [m²]."""
    return 2.0 * sum(area for *_, area in case.interfaces)


def _finest(case: NewCase) -> float:
    """Return the size at interfaces with which a mesh has as many cells as it may [m]."""
    growth = case.growth or GROWTH
    area, more = _sides(case), (MOST_GROWTH[3] - 1.0) * _coarse_cells(case)

    def excess(size: float) -> float:
        return EDGES * area * _layers(case, size) / growth - more

    least_size = 1e-3 * case.size
    if excess(least_size) <= 0.0:
        return least_size
    return float(brentq(excess, least_size, case.size, xtol=1e-3 * case.size))
