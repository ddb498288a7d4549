"""Engine block with liners and a water-jacket core, in a die of two halves with channels.

    python3 -m demos.parts.block block.step [--cylinders 3] [--mesh block.msh --size 8]

The lower half of the die forms the crankcase and the bores, on which the liners sit; it is filled
from below through gates at the ends of the rail. The upper half forms the outside, the deck and the
bolt holes. The jacket core is held by prints at both sides.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import sqrt

from demos.parts.assembly import Assembly, Box
from demos.parts.command import main
from demos.parts.solids import (
    Point,
    box,
    cylinder,
    drilled,
    fused,
    prism,
    rounded_box,
    without,
)


@dataclass(frozen=True)
class Block:
    """Dimensions in mm; x along the crankshaft, whose axis lies at y = z = 0, z upwards."""

    cylinders: int = 3
    pitch: float = 82.0
    bore: float = 54.0
    liner: float = 4.0
    wall: float = 5.0
    jacket: float = 9.0
    jacket_floor: float = 72.0
    jacket_roof: float = 130.0
    deck: float = 140.0
    roof: float = 62.0
    skirt: float = 6.0
    width: float = 124.0
    corner: float = 12.0
    bay_corner: float = 8.0
    bay_roof: float = 4.0
    ledge: float = 6.0
    bulkhead: float = 12.0
    saddle: float = 32.0
    saddle_boss: float = 52.0
    rail: float = 9.0
    rail_height: float = 8.0
    rib: float = 6.0
    bolt_boss: float = 18.0
    bolt: float = 8.0
    bolt_depth: float = 40.0
    core_print: float = 18.0
    print: float = 10.0
    gate: float = 10.0
    die: float = 30.0
    channel: float = 10.0


def block(p: Block) -> Assembly:
    """Return the block in its die."""
    core = jacket_core(p)
    liners = [liner(p, x) for x in centres(p)]
    casting = cast_part(p, core)
    lower, upper = die_halves(p, (casting, core, *liners))
    solids = {"casting": casting, "lower": lower, "upper": upper, "jacket": core}
    solids |= {f"liner-{number}": tag for number, tag in enumerate(liners, 1)}
    coarse = frozenset(("lower", "upper"))
    return Assembly("block", solids, surfaces(p), coarse, apart(p))


def apart(p: Block) -> dict[str, Point]:
    """Return how far the bodies are moved in an exploded view."""
    far = {"lower": (0.0, 0.0, -210.0), "upper": (0.0, 0.0, 240.0), "jacket": (0.0, -150.0, 60.0)}
    return far | {f"liner-{n + 1}": (0.0, 0.0, 100.0) for n in range(p.cylinders)}


def centres(p: Block) -> list[float]:
    """Return where the cylinders stand."""
    return [(n - 0.5 * (p.cylinders - 1)) * p.pitch for n in range(p.cylinders)]


def between(p: Block) -> list[float]:
    """Return the places half a pitch before and after each cylinder."""
    return [(n - 0.5 * p.cylinders) * p.pitch for n in range(p.cylinders + 1)]


def radius(p: Block, layers: int) -> float:
    """Return a radius of a cylinder: 0 bore, 1 liner, 2 wall, 3 jacket, 4 outer wall."""
    return 0.5 * p.bore + sum((p.liner, p.wall, p.jacket, p.wall)[:layers])


def half_length(p: Block) -> float:
    """Return half the length of the block without its rail: the bolts of the ends stand on it."""
    return 0.5 * (p.cylinders * p.pitch + p.bolt_boss) + 3.0


def columns(p: Block, r: float, low: float, high: float) -> list[int]:
    """Return upright cylinders of a radius at the places of all cylinders."""
    return [cylinder((x, 0.0, low), (0.0, 0.0, high - low), r) for x in centres(p)]


def jacket_core(p: Block) -> int:
    """Return the core of the water jacket with its prints at both sides."""
    low, high = p.jacket_floor, p.jacket_roof
    ring = fused(*columns(p, radius(p, 3), low, high))
    ring = drilled(ring, *columns(p, radius(p, 2), low, high))
    middle, z = 0.5 * (radius(p, 2) + radius(p, 3)), 0.5 * (low + high)
    reach = radius(p, 4) + p.print - middle
    prints = [
        cylinder((x, side * middle, z), (0.0, side * reach, 0.0), 0.5 * p.core_print)
        for x in centres(p)
        for side in (-1.0, 1.0)
    ]
    return fused(ring, *prints)


def liner(p: Block, x: float) -> int:
    """Return the liner of a cylinder, from its ledge to the deck."""
    up = (0.0, 0.0, p.deck - liner_foot(p))
    foot = (x, 0.0, liner_foot(p))
    return drilled(cylinder(foot, up, radius(p, 1)), cylinder(foot, up, radius(p, 0)))


def liner_foot(p: Block) -> float:
    """Return the height at which liners begin."""
    return p.roof - 0.5 * p.ledge


def cast_part(p: Block, core: int) -> int:
    """Return the casting with its gates."""
    outer = columns(p, radius(p, 4), p.roof - p.ledge, p.deck)
    part = fused(crankcase(p), *outer, *bolt_bosses(p))
    part = drilled(part, *bolt_holes(p), *columns(p, radius(p, 0), 0.0, p.deck))
    part = drilled(part, *columns(p, radius(p, 1), liner_foot(p), p.deck))
    return fused(without(part, core), *gates(p))


def bolt_places(p: Block) -> Iterator[tuple[float, float]]:
    """Yield where the bolts of the head stand, clear of the jacket by half a wall."""
    y = sqrt((radius(p, 3) + 0.5 * (p.bolt_boss + p.wall)) ** 2 - 0.25 * p.pitch**2)
    for x in between(p):
        yield x, y
        yield x, -y


def bolt_bosses(p: Block) -> list[int]:
    """Return the columns of the head bolts."""
    low = p.roof - p.ledge
    up = (0.0, 0.0, p.deck - low)
    return [cylinder((x, y, low), up, 0.5 * p.bolt_boss) for x, y in bolt_places(p)]


def bolt_holes(p: Block) -> list[int]:
    """Return the holes of the head bolts."""
    foot, up = p.deck - p.bolt_depth, (0.0, 0.0, p.bolt_depth)
    return [cylinder((x, y, foot), up, 0.5 * p.bolt) for x, y in bolt_places(p)]


def crankcase(p: Block) -> int:
    """Return skirt, rail, ribs, bulkheads and saddles."""
    x, y = half_length(p), 0.5 * p.width
    skirt = rounded_box((-x, -y, 0.0), (x, y, p.roof), p.corner)
    wide = (x + p.rail, y + p.rail)
    rail = rounded_box((-wide[0], -wide[1], 0.0), (*wide, p.rail_height), p.corner)
    part = drilled(fused(skirt, rail, *ribs(p)), *bays(p))
    return drilled(fused(part, *saddle_bosses(p)), saddle_bore(p))


def bays(p: Block) -> list[int]:
    """Return the rooms of the crankcase, one below each cylinder."""
    found = []
    y, end = 0.5 * p.width - p.skirt, half_length(p) - p.skirt
    for number, x in enumerate(centres(p)):
        room = 0.5 * (p.pitch - p.bulkhead)
        low = -end if number == 0 else x - room
        high = end if number == p.cylinders - 1 else x + room
        corners = (low, -y, 0.0), (high, y, p.roof - p.ledge)
        found.append(rounded_box(*corners, p.bay_corner, p.bay_roof))
    return found


def saddle_bosses(p: Block) -> list[int]:
    """Return half discs round the saddles, a little thicker than the bulkheads."""
    found = []
    end, thick = half_length(p), p.bulkhead + 6.0
    for number, middle in enumerate(between(p)):
        low = -end if number == 0 else middle - 0.5 * thick
        low = end - thick if number == p.cylinders else low
        disc = cylinder((low, 0.0, 0.0), (thick, 0.0, 0.0), 0.5 * p.saddle_boss)
        r = p.saddle_boss
        found.append(drilled(disc, box((low - 1.0, -r, -r), (low + thick + 1.0, r, 0.0))))
    return found


def saddle_bore(p: Block) -> int:
    """Return the bore of the saddles."""
    end = half_length(p) + p.rail
    return cylinder((-end, 0.0, 0.0), (2.0 * end, 0.0, 0.0), 0.5 * p.saddle)


def ribs(p: Block) -> list[int]:
    """Return ribs between rail and skirt on both sides, at the bulkheads between cylinders."""
    found = []
    y, z, half = 0.5 * p.width, p.rail_height, 0.5 * p.rib
    for x in between(p)[1:-1]:
        for side in (-1.0, 1.0):
            corners = [(y - 2.0, z - 2.0), (y + p.rail, z - 2.0), (y + p.rail, z)]
            corners += [(y + 3.0, p.roof - 8.0), (y - 2.0, p.roof - 8.0)]
            found.append(prism([(x - half, side * a, b) for a, b in corners], (p.rib, 0.0, 0.0)))
    return found


def gates(p: Block) -> list[int]:
    """Return the gates below the ends of the rail."""
    x = half_length(p) + 0.5 * (p.rail - p.skirt)
    return [
        cylinder((a * x, b * 0.2 * p.width, -p.die), (0.0, 0.0, p.die), 0.5 * p.gate)
        for a in (-1.0, 1.0)
        for b in (-1.0, 1.0)
    ]


def die_corners(p: Block) -> Box:
    """Return the corners of the die."""
    x, y = half_length(p) + p.rail + p.die, 0.5 * p.width + p.rail + p.die
    return (-x, -y, -p.die), (x, y, p.deck + p.die)


def die_halves(p: Block, inner: tuple[int, ...]) -> tuple[int, int]:
    """Return the lower half with crankcase and bores, and the upper one with the outside."""
    low, high = die_corners(p)
    end = half_length(p)
    saddle = cylinder((-end, 0.0, 0.0), (2.0 * end, 0.0, 0.0), 0.5 * p.saddle)
    bores = columns(p, radius(p, 0), 0.0, p.deck)
    plate = box(low, (high[0], high[1], p.rail_height))
    lower = fused(plate, saddle, *bores, *bays(p))
    upper = without(box((low[0], low[1], p.rail_height), high), lower)
    below, above = channels(p)
    lower, upper = drilled(lower, *below), drilled(upper, *above)
    return without(lower, *inner), without(upper, *inner)


def channel_places(p: Block) -> tuple[tuple[float, float], ...]:
    """Return y and z of the channels along the lower and along the upper half."""
    inner, outer = 0.3 * p.width, 0.5 * (p.width + p.die)
    high = 0.5 * (p.jacket_floor + p.jacket_roof)
    return (-inner, -0.6 * p.die), (inner, -0.6 * p.die), (-outer, high), (outer, high)


def channels(p: Block) -> tuple[list[int], list[int]]:
    """Return the channels of the lower and of the upper half."""
    low, high = die_corners(p)
    along = (high[0] - low[0], 0.0, 0.0)
    found = [cylinder((low[0], y, z), along, 0.5 * p.channel) for y, z in channel_places(p)]
    return found[:2], found[2:]


def surfaces(p: Block) -> dict[str, tuple[Box, ...]]:
    """Return boxes round the channels and the feet of the gates."""
    low, high = die_corners(p)
    r = 0.5 * p.channel
    around = tuple(((low[0], y - r, z - r), (high[0], y + r, z + r)) for y, z in channel_places(p))
    x, y = half_length(p), 0.5 * p.width
    feet = tuple(
        ((a, -y, low[2]), (b, y, low[2]))
        for a, b in ((-x - p.rail, -x + p.rail), (x - p.rail, x + p.rail))
    )
    return {"channel": around, "gate": feet}


if __name__ == "__main__":
    main(block, Block, __doc__)
