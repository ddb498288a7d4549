"""Thin-walled housing round a sand core, in a sand mould of cope and drag.

    python3 -m demos.parts.housing housing.step [--wall 5] [--mesh housing.msh --size 6]

The mould parts at the underside of the flange. The core stands with its print in the drag and
reaches through the bearing with a tail that is laid down from above.
"""

from dataclasses import dataclass

from demos.parts.assembly import Assembly, Box
from demos.parts.command import main
from demos.parts.solids import (
    box,
    cone,
    cylinder,
    drilled,
    edges,
    filleted,
    fused,
    rounded_box,
    without,
)


@dataclass(frozen=True)
class Housing:
    """Dimensions in mm; the middle of the flange's underside lies at the origin, z upwards."""

    length: float = 120.0
    width: float = 80.0
    height: float = 60.0
    wall: float = 4.0
    corner: float = 14.0
    roof: float = 8.0
    flange: float = 14.0
    flange_height: float = 7.0
    root: float = 3.0
    hole: float = 7.0
    bearing: float = 36.0
    bearing_height: float = 30.0
    bearing_length: float = 14.0
    bore: float = 22.0
    neck: float = 14.0
    neck_height: float = 8.0
    feeder: float = 26.0
    print: float = 14.0
    mould: float = 25.0
    top: float = 105.0


APART = {"drag": (0.0, 0.0, -100.0), "cope": (0.0, 0.0, 150.0), "core": (0.0, 0.0, -45.0)}


def housing(p: Housing) -> Assembly:
    """Return the housing in its mould."""
    core = sand_core(p)
    casting = cast_part(p, core)
    drag, cope = mould_halves(p, casting, core)
    solids = {"casting": casting, "drag": drag, "cope": cope, "core": core}
    coarse = frozenset(("drag", "cope"))
    return Assembly("housing", solids, surfaces(p), coarse, APART)


def sand_core(p: Housing) -> int:
    """Return the core: the inside, its print below, the bore and the tail outside the bearing."""
    x, y = 0.5 * p.length - p.wall, 0.5 * p.width - p.wall
    corner, roof = p.corner - p.wall, p.roof - p.wall
    inner = rounded_box((-x, -y, -p.print), (x, y, p.height - p.wall), corner, roof)
    end = 0.5 * p.length + p.bearing_length
    axis = (x - 2.0, 0.0, p.bearing_height)
    bore = cylinder(axis, (end + p.print - axis[0], 0.0, 0.0), 0.5 * p.bore)
    half = 0.5 * p.bore
    tail = box((end, -half, 0.0), (end + p.print, half, p.bearing_height))
    return fused(inner, bore, tail)


def cast_part(p: Housing, core: int) -> int:
    """Return the housing with its feeder."""
    x, y = 0.5 * p.length, 0.5 * p.width
    shell = rounded_box((-x, -y, 0.0), (x, y, p.height), p.corner, p.roof)
    wide = (x + p.flange, y + p.flange)
    rail = rounded_box((-wide[0], -wide[1], 0.0), (*wide, p.flange_height), p.corner)
    shell = fused(shell, rail)
    z = p.flange_height
    shell = filleted(shell, edges(shell, (-x, -y, z), (x, y, z)), p.root)
    holes = [
        cylinder((a * (x + 0.57 * p.flange), b * 0.7 * y, 0.0), (0.0, 0.0, z), 0.5 * p.hole)
        for a in (-1.0, 1.0)
        for b in (-1.0, 1.0)
    ]
    return without(drilled(fused(shell, bearing(p), feeder(p)), *holes), core)


def bearing(p: Housing) -> int:
    """Return the boss of the bearing, on a pad down to the flange."""
    x, r, z = 0.5 * p.length - 0.5 * p.wall, 0.5 * p.bearing, p.bearing_height
    length = p.bearing_length + 0.5 * p.wall
    boss = cylinder((x, 0.0, z), (length, 0.0, 0.0), r)
    return fused(boss, box((x, -r, 0.5 * p.flange_height), (x + length, r, z)))


def feeder(p: Housing) -> int:
    """Return the feeder on its neck."""
    foot = p.height - 0.5 * p.wall
    neck = cylinder((0.0, 0.0, foot), (0.0, 0.0, p.neck_height), 0.5 * p.neck)
    high = foot + p.neck_height
    return fused(
        neck,
        cone((0.0, 0.0, high), (0.0, 0.0, p.top - high), (0.5 * p.feeder - 2.0, 0.5 * p.feeder)),
    )


def mould_corners(p: Housing) -> Box:
    """Return the corners of the mould."""
    x, y = 0.5 * p.length + p.flange + p.mould, 0.5 * p.width + p.flange + p.mould
    return (-x, -y, -p.print - p.mould), (x, y, p.top)


def mould_halves(p: Housing, casting: int, core: int) -> tuple[int, int]:
    """Return drag and cope."""
    low, high = mould_corners(p)
    drag, cope = box(low, (high[0], high[1], 0.0)), box((low[0], low[1], 0.0), high)
    return without(drag, casting, core), without(cope, casting, core)


def surfaces(p: Housing) -> dict[str, tuple[Box, ...]]:
    """Return the box round the top of the feeder."""
    r = 0.5 * p.feeder
    return {"top": (((-r, -r, p.top), (r, r, p.top)),)}


if __name__ == "__main__":
    main(housing, Housing, __doc__)
