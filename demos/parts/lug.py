"""Small lug: a plate with a boss, a bore and fillets, one solid without anything round it.

    python3 -m demos.parts.lug lug.step [--length 60]

The part of the tutorial: its mould, channel and surfaces are made by the case file.
"""

from dataclasses import dataclass

from demos.parts.assembly import Assembly
from demos.parts.command import main
from demos.parts.solids import box, cylinder, drilled, edges, filleted, fused


@dataclass(frozen=True)
class Lug:
    """Dimensions in mm; the plate lies on z = 0, the boss stands in the origin."""

    length: float = 60.0
    width: float = 30.0
    thickness: float = 10.0
    boss: float = 10.0
    height: float = 26.0
    bore: float = 4.0
    fillet: float = 4.0


def lug(p: Lug) -> Assembly:
    """Draw the lug in the current gmsh model."""
    half = 0.5 * p.width
    plate = box((-half, -half, 0.0), (p.length - half, half, p.thickness))
    part = fused(plate, cylinder((0.0, 0.0, 0.0), (0.0, 0.0, p.height), p.boss))
    end = p.length - half
    corners = [(end, side, 0.0) for side in (-half, half)]
    upright = [tag for x, y, z in corners for tag in edges(part, (x, y, z), (x, y, p.thickness))]
    part = filleted(part, upright, p.fillet)
    hole = cylinder((end - half, 0.0, -1.0), (0.0, 0.0, p.thickness + 2.0), p.bore)
    return Assembly("lug", {"lug": drilled(part, hole)}, {})


if __name__ == "__main__":
    main(lug, Lug, __doc__)
