"""CAD files that tests write themselves with gmsh's OpenCASCADE kernel, in millimetres."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import gmsh

from castx.domain.source import gmsh_session

LABEL = re.compile(r"'Open CASCADE STEP translator [\d.]+ \d+(?:\.(\d+))?'")
"""The labels that OpenCASCADE gives: of the assembly, and with a second number of its solids."""
MILLIMETRE = "SI_UNIT(.MILLI.,.METRE.)"
INCH = """#900001 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#900002 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#900003);
#900003 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );
ENDSEC;
END-ISO"""
Solids = Callable[[Any], Sequence[int]]


def write_cad(path: Path, solids: Solids, names: Sequence[str] = (), place: Any = None) -> Path:
    """Write a CAD file.

    Args:
        path: with the end of its format.
        solids: makes them with the kernel it gets, and returns their tags.
        names: labels of the solids, in a STEP file.
        place: moves the solids with the kernel and their (dimension, tag).
    """
    with gmsh_session():
        tags = solids(gmsh.model.occ)
        if place is not None:
            place(gmsh.model.occ, [(3, tag) for tag in tags])
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    if names:
        relabel(path, names)
    return path


def relabel(path: Path, names: Sequence[str]) -> None:
    """Write labels into a STEP file, which gmsh cannot."""

    def label(found: re.Match[str]) -> str:
        number = found[1]
        if number is None:
            return f"'{names[0]}'" if len(names) == 1 else "'assembly'"
        return f"'{names[int(number) - 1]}'"

    path.write_text(LABEL.sub(label, path.read_text()))


def in_inches(path: Path) -> None:
    """Let the numbers of a STEP file be inches."""
    text = path.read_text().replace(
        f"( LENGTH_UNIT() NAMED_UNIT(*) {MILLIMETRE} )",
        "( CONVERSION_BASED_UNIT('INCH',#900002) LENGTH_UNIT() NAMED_UNIT(#900001) )",
    )
    path.write_text(text.replace("ENDSEC;\nEND-ISO", INCH))


def two_blocks(occ: Any, shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> list[int]:
    """A block of 20 x 20 x 10 on one of 30 x 20 x 10; the upper one may be shifted."""
    upper = occ.addBox(*shift, 20, 20, 10)
    return [upper, occ.addBox(0, 0, -10, 30, 20, 10)]


def bush_in_ring(occ: Any, height: float = 12.0) -> list[int]:
    """A round bush of radius 10 in a ring of radius 20."""
    bush, whole, hole = (occ.addCylinder(0, 0, 0, 0, 0, height, r) for r in (10, 20, 10))
    ((_, ring),), _ = occ.cut([(3, whole)], [(3, hole)])
    return [bush, ring]


def rounded_block(occ: Any, radius: float = 4.0) -> list[int]:
    """A block of 30 x 20 x 10 whose four upright edges have fillets."""
    block = occ.addBox(0, 0, 0, 30, 20, 10)
    occ.synchronize()
    upright = []
    for _, edge in gmsh.model.getEntities(1):
        box = gmsh.model.getBoundingBox(1, edge)
        if box[5] - box[2] > 9:
            upright.append(edge)
    ((_, rounded),) = occ.fillet([block], upright, [radius])
    return [rounded]
