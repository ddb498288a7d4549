"""Bracket with ribs, bosses, holes, fillets and a feeder, in a die of two halves with a chill.

    python3 -m demos.parts.bracket bracket.step [--length 90] [--mesh bracket.msh --size 5]

The die opens upwards at the top of the base plate. The pad on the wall carries a bore, which a
steel pin keeps open; the feeder stands on the pad, and a copper chill under it.
"""

from dataclasses import dataclass

from demos.parts.assembly import Assembly, Box
from demos.parts.command import main
from demos.parts.solids import (
    box,
    cylinder,
    drilled,
    edges,
    filleted,
    fused,
    prism,
    without,
)


@dataclass(frozen=True)
class Bracket:
    """Dimensions in mm; x along the plate, y along the wall, z upwards, 0 at the underside."""

    length: float = 100.0
    width: float = 100.0
    height: float = 60.0
    plate: float = 8.0
    wall: float = 8.0
    rib: float = 7.0
    pad: float = 22.0
    bore: float = 14.0
    bore_height: float = 38.0
    boss: float = 20.0
    boss_height: float = 16.0
    hole: float = 9.0
    window: float = 18.0
    feeder: float = 18.0
    feeder_height: float = 95.0
    die: float = 30.0
    channel: float = 8.0
    chill: float = 14.0
    chill_length: float = 28.0
    root: float = 6.0
    corner: float = 4.0
    fillet: float = 3.0


def bracket(p: Bracket) -> Assembly:
    """Return the bracket in its die."""
    casting = cast_part(p)
    pin = bore_pin(p)
    y = 0.5 * p.width
    chill = box((4.0, y - p.chill, -p.chill), (4.0 + p.chill_length, y + p.chill, 0.0))
    lower, upper = die_halves(p, casting, pin, chill)
    solids = {"casting": casting, "lower": lower, "upper": upper, "pin": pin, "chill": chill}
    return Assembly("bracket", solids, surfaces(p), frozenset(("lower", "upper")), APART)


APART = {
    "lower": (0.0, 0.0, -70.0),
    "upper": (0.0, 0.0, 130.0),
    "pin": (-60.0, 0.0, 0.0),
    "chill": (0.0, 0.0, -30.0),
}


def cast_part(p: Bracket) -> int:
    """Return the casting with its feeder."""
    part = filleted_angle(p)
    part = fused(part, *(rib(p, y) for y in rib_places(p)), pad(p), feeder(p))
    part = filleted(part, rib_roots(p, part), p.fillet)
    for y in boss_places(p):
        boss = cylinder(
            (boss_x(p), y, 0.5 * p.plate), (0, 0, p.boss_height - 0.5 * p.plate), 0.5 * p.boss
        )
        part = fused(part, boss)
        r = 0.5 * p.boss
        ring = ((boss_x(p) - r, y - r, p.plate), (boss_x(p) + r, y + r, p.plate))
        part = filleted(part, edges(part, *ring), p.fillet)
    holes = [
        cylinder((boss_x(p), y, 0), (0, 0, p.boss_height), 0.5 * p.hole) for y in boss_places(p)
    ]
    window = cylinder((0.45 * p.length, 0.5 * p.width, 0.0), (0, 0, p.plate), 0.5 * p.window)
    bore = cylinder((0, 0.5 * p.width, p.bore_height), (p.pad, 0, 0), 0.5 * p.bore)
    return drilled(part, *holes, window, bore)


def boss_x(p: Bracket) -> float:
    """Return where along the plate its bosses stand."""
    return p.length - p.boss


def boss_places(p: Bracket) -> tuple[float, float]:
    """Return where across the plate its bosses stand."""
    return 0.33 * p.width, 0.67 * p.width


def rib_places(p: Bracket) -> tuple[float, float]:
    """Return the middles of the ribs."""
    return 0.12 * p.width, 0.88 * p.width


def filleted_angle(p: Bracket) -> int:
    """Return plate and wall with round corners, and a fillet where they meet."""
    profile = [(0, 0), (p.length, 0), (p.length, p.plate), (p.wall, p.plate), (p.wall, p.height)]
    points = [(float(x), 0.0, float(z)) for x, z in (*profile, (0, p.height))]
    part = prism(points, (0.0, p.width, 0.0))
    inner = edges(part, (p.wall, 0.0, p.plate), (p.wall, p.width, p.plate))
    part = filleted(part, inner, p.root)
    outer = edges(part, (p.length, 0.0, 0.0), (p.length, p.width, p.plate))
    upright = [e for e in outer if e in edges(part, (p.length, 0.0, 0.0), (p.length, 0.0, p.plate))]
    upright += edges(part, (p.length, p.width, 0.0), (p.length, p.width, p.plate))
    return filleted(part, upright, p.corner)


def rib(p: Bracket, y: float) -> int:
    """Return the rib at a place, from the top of the wall to the end of the plate."""
    x, z = 0.5 * p.wall, 0.5 * p.plate
    toe = (p.length, 2.0 * p.plate)
    top = (p.wall + p.root, p.height)
    points = [(x, z), (p.length, z), toe, top, (x, p.height)]
    return prism([(a, y - 0.5 * p.rib, b) for a, b in points], (0.0, p.rib, 0.0))


def rib_roots(p: Bracket, part: int) -> list[int]:
    """Return the edges along the feet of the ribs: on plate, wall and the fillet between."""
    found = []
    for middle in rib_places(p):
        for y in (middle - 0.5 * p.rib, middle + 0.5 * p.rib):
            for low, high in root_boxes(p):
                found += edges(part, (low[0], y, low[1]), (high[0], y, high[1]))
    return found


def root_boxes(p: Bracket) -> tuple[tuple[tuple[float, float], tuple[float, float]], ...]:
    """Return boxes in (x, z) round the feet of a rib."""
    wall, plate = p.wall, p.plate
    return (
        ((wall, plate), (p.length, plate)),
        ((wall, plate), (wall, p.height)),
        ((wall, plate), (wall + p.root, plate + p.root)),
    )


def pad(p: Bracket) -> int:
    """Return the pad of the bore: a half cylinder on a box down to the plate."""
    r, y, foot = 0.75 * p.pad, 0.5 * p.width, 0.5 * p.plate
    arch = cylinder((0.0, y, p.bore_height), (p.pad, 0.0, 0.0), r)
    return fused(arch, box((0.0, y - r, foot), (p.pad, y + r, p.bore_height)))


def feeder(p: Bracket) -> int:
    """Return the feeder, from the bore up to the top of the die."""
    foot = p.bore_height
    return cylinder(
        (0.5 * p.pad, 0.5 * p.width, foot), (0, 0, p.feeder_height - foot), 0.5 * p.feeder
    )


def bore_pin(p: Bracket) -> int:
    """Return the pin through the bore, from the outside of the die."""
    foot = (-p.die, 0.5 * p.width, p.bore_height)
    return cylinder(foot, (p.die + p.pad, 0.0, 0.0), 0.5 * p.bore)


def die_corners(p: Bracket) -> Box:
    """Return the corners of the die."""
    high = (p.length + p.die, p.width + p.die, p.feeder_height)
    return (-p.die, -p.die, -p.die), high


def die_halves(p: Bracket, casting: int, pin: int, chill: int) -> tuple[int, int]:
    """Return the halves below and above the parting plane, with a channel in each."""
    low, high = die_corners(p)
    lower = box(low, (high[0], high[1], p.plate))
    upper = box((low[0], low[1], p.plate), high)
    across = (0.0, high[1] - low[1], 0.0)
    below, above = (
        cylinder((channel_x(p), low[1], z), across, 0.5 * p.channel) for z in channel_heights(p)
    )
    lower, upper = drilled(lower, below), drilled(upper, above)
    return without(lower, casting, chill), without(upper, casting, pin)


def channel_x(p: Bracket) -> float:
    """Return where along the plate the channels run."""
    return 0.7 * p.length


def channel_heights(p: Bracket) -> tuple[float, float]:
    """Return the heights of the channels, one in each half of the die."""
    return -0.6 * p.die, p.boss_height + 0.8 * p.die


def surfaces(p: Bracket) -> dict[str, tuple[Box, ...]]:
    """Return boxes round the channels and the top of the feeder."""
    x, r = channel_x(p), 0.5 * p.channel
    low, high = die_corners(p)
    channels = tuple(((x - r, low[1], z - r), (x + r, high[1], z + r)) for z in channel_heights(p))
    inner = (0.0, 0.0, p.feeder_height), (p.pad, p.width, p.feeder_height)
    return {"channel": channels, "top": (inner,)}


if __name__ == "__main__":
    main(bracket, Bracket, __doc__)
