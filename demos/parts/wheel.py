"""Flanged wheel with spokes and a bore core, in a die of two halves with ring channels.

    python3 -m demos.parts.wheel wheel.step [--spokes 6] [--mesh wheel.msh --size 6]

The die opens along the axis: at the top of the flange outside the rim, at the middle of the spokes
inside. A disc feeder stands on the hub, over the end of the sand core.
"""

from dataclasses import dataclass

from demos.parts.assembly import Assembly, Box
from demos.parts.command import main
from demos.parts.solids import (
    box,
    common,
    cylinder,
    drilled,
    edges,
    filleted,
    fused,
    on_cylinder,
    torus,
    turned,
    turned_copies,
    without,
)


@dataclass(frozen=True)
class Wheel:
    """Dimensions in mm; z along the axis, 0 at the underside of the wheel.

    With `half` = 1 the part at y > 0 is left, and y = 0 is a plane of symmetry.
    """

    radius: float = 96.0
    rim: float = 12.0
    rim_height: float = 50.0
    draft: float = 3.0
    flange: float = 12.0
    flange_height: float = 10.0
    hub: float = 28.0
    hub_height: float = 46.0
    bore: float = 13.0
    spokes: int = 5
    spoke: float = 22.0
    spoke_height: float = 16.0
    spoke_floor: float = 12.0
    rounding: float = 4.0
    fillet: float = 4.0
    feeder: float = 22.0
    feeder_height: float = 76.0
    print: float = 15.0
    die: float = 30.0
    channel: float = 8.0
    half: int = 0


APART = {"lower": (0.0, 0.0, -110.0), "upper": (0.0, 0.0, 150.0), "core": (0.0, 0.0, -55.0)}


def wheel(p: Wheel) -> Assembly:
    """Return the wheel in its die."""
    casting = cast_part(p)
    core = cylinder((0.0, 0.0, -p.print), (0.0, 0.0, p.print + p.hub_height), p.bore)
    lower, upper = die_halves(p, casting, core)
    solids = {"casting": casting, "lower": lower, "upper": upper, "core": core}
    if p.half:
        solids = {name: common(tag, half_space(p)) for name, tag in solids.items()}
    return Assembly("wheel", solids, surfaces(p), frozenset(("lower", "upper")), APART)


def outer(p: Wheel) -> float:
    """Return the radius of the die."""
    return p.radius + p.flange + p.die


def middle(p: Wheel) -> float:
    """Return the height of the middle of the spokes, where the die parts inside the rim."""
    return p.spoke_floor + 0.5 * p.spoke_height


def cast_part(p: Wheel) -> int:
    """Return the wheel with its feeder, bored."""
    part = fused(rim(p), hub(p), *turned_copies(spoke(p), p.spokes))
    part = filleted(part, spoke_roots(p, part), p.fillet)
    return drilled(part, cylinder((0.0, 0.0, 0.0), (0.0, 0.0, p.hub_height), p.bore))


def rim(p: Wheel) -> int:
    """Return rim and flange, drafted above the flange."""
    inner, wide = p.radius - p.rim, p.radius + p.flange
    profile = [(inner, 0.0), (wide, 0.0), (wide, p.flange_height), (p.radius, p.flange_height)]
    profile += [(p.radius - p.draft, p.rim_height), (inner, p.rim_height)]
    part = turned(profile)
    corner = p.radius + 1.0, p.flange_height
    ring = edges(part, (-corner[0], -corner[0], corner[1]), (corner[0], corner[0], corner[1]))
    return filleted(part, ring, p.fillet)


def hub(p: Wheel) -> int:
    """Return hub and feeder without the bore."""
    high = p.hub_height
    profile = [(0.0, 0.0), (p.hub, 0.0), (p.hub, high)]
    profile += [
        (p.feeder, high),
        (p.feeder - 0.5 * p.draft, p.feeder_height),
        (0.0, p.feeder_height),
    ]
    return turned(profile)


def spoke(p: Wheel) -> int:
    """Return a spoke with round edges along x, from within the hub to within the rim."""
    start, end = 0.6 * p.hub, p.radius - 0.5 * p.rim
    half, floor = 0.5 * p.spoke, p.spoke_floor
    bar = box((start, -half, floor), (end, half, floor + p.spoke_height))
    along: list[int] = []
    for y in (-half, half):
        for z in (floor, floor + p.spoke_height):
            along += edges(bar, (start, y, z), (end, y, z))
    return filleted(bar, along, p.rounding)


def spoke_roots(p: Wheel, part: int) -> list[int]:
    """Return the edges round the ends of the spokes, at the hub and at the rim."""
    inner = p.radius - p.rim
    low, high = p.spoke_floor, p.spoke_floor + p.spoke_height
    found = edges(part, (-inner, -inner, low), (inner, inner, high))
    return on_cylinder(found, p.hub) + on_cylinder(found, inner)


def die_halves(p: Wheel, casting: int, core: int) -> tuple[int, int]:
    """Return the halves below and above the stepped parting, with a ring channel in each."""
    low, step = -p.die, p.radius - 0.5 * p.rim
    profile = [(0.0, low), (outer(p), low), (outer(p), p.flange_height), (step, p.flange_height)]
    lower = turned([*profile, (step, middle(p)), (0.0, middle(p))])
    upper = cylinder((0.0, 0.0, low), (0.0, 0.0, p.feeder_height - low), outer(p))
    upper = without(upper, lower)
    below, above = (torus((0.0, 0.0, z), ring_radius(p), 0.5 * p.channel) for z in ring_heights(p))
    lower, upper = drilled(lower, below), drilled(upper, above)
    return without(lower, casting, core), without(upper, casting, core)


def ring_radius(p: Wheel) -> float:
    """Return the radius of the ring channels."""
    return p.radius - 0.5 * p.rim


def ring_heights(p: Wheel) -> tuple[float, float]:
    """Return the heights of the ring channels: in the middle of the die below and above the rim."""
    return -0.5 * p.die, 0.5 * (p.rim_height + p.feeder_height)


def half_space(p: Wheel) -> int:
    """Return a box round everything at y > 0."""
    wide = outer(p)
    return box((-wide, 0.0, -p.die), (wide, wide, p.feeder_height))


def surfaces(p: Wheel) -> dict[str, tuple[Box, ...]]:
    """Return boxes round the channels, the top of the feeder and the plane of symmetry."""
    wide, r = outer(p), p.channel
    channels = tuple(((-wide, -wide, z - r), (wide, wide, z + r)) for z in ring_heights(p))
    top = ((-p.feeder, -p.feeder, p.feeder_height), (p.feeder, p.feeder, p.feeder_height))
    found = {"channel": channels, "top": (top,)}
    if p.half:
        found["symmetry-y"] = (((-wide, 0.0, -p.die), (wide, 0.0, p.feeder_height)),)
    return found


if __name__ == "__main__":
    main(wheel, Wheel, __doc__)
