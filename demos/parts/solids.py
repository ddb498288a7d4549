"""Simple solids and what is made of them, by gmsh's OpenCASCADE kernel; lengths in mm.

A solid is the tag of a volume of the current gmsh model. Functions that combine solids consume
them, unless they say otherwise.
"""

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import tau

import gmsh
import numpy as np
import numpy.typing as npt

Point = tuple[float, float, float]
FLAT = (0.0, 0.0, 0.0)


@contextmanager
def drawing(name: str) -> Iterator[None]:
    """Open a silent gmsh with an empty model."""
    gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.model.add(name)
        yield
    finally:
        gmsh.finalize()


@contextmanager
def quiet() -> Iterator[None]:
    """Let nothing be printed: OpenCASCADE tells of each file that it writes, past all options."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def box(low: Point, high: Point) -> int:
    """Return the box between two corners."""
    size = (end - start for start, end in zip(low, high, strict=True))
    return int(gmsh.model.occ.addBox(*low, *size))


def cylinder(foot: Point, axis: Point, radius: float) -> int:
    """Return a cylinder from the middle of its foot along an axis."""
    return int(gmsh.model.occ.addCylinder(*foot, *axis, radius))


def cone(foot: Point, axis: Point, radii: tuple[float, float]) -> int:
    """Return a frustum from the middle of its foot, with the radii there and at its end."""
    return int(gmsh.model.occ.addCone(*foot, *axis, *radii))


def torus(middle: Point, ring: float, radius: float) -> int:
    """Return a ring about the direction z, whose section has a radius."""
    return int(gmsh.model.occ.addTorus(*middle, ring, radius))


def face(points: Sequence[Point]) -> int:
    """Return the plane face inside a polygon."""
    occ = gmsh.model.occ
    corners = [occ.addPoint(*point) for point in points]
    lines = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    return int(occ.addPlaneSurface([occ.addCurveLoop(lines)]))


def prism(points: Sequence[Point], along: Point) -> int:
    """Return the solid that a polygon passes over as it moves."""
    swept = gmsh.model.occ.extrude([(2, face(points))], *along)
    return next(int(tag) for dimension, tag in swept if dimension == 3)


def turned(profile: Sequence[tuple[float, float]]) -> int:
    """Return the solid of a polygon in (r, z) turned about the axis z."""
    points = [(r, 0.0, z) for r, z in profile]
    swept = gmsh.model.occ.revolve([(2, face(points))], *FLAT, 0.0, 0.0, 1.0, tau)
    return next(int(tag) for dimension, tag in swept if dimension == 3)


def fused(first: int, *others: int) -> int:
    """Return the union of solids that touch or overlap."""
    if not others:
        return first
    return only(gmsh.model.occ.fuse([(3, first)], [(3, tag) for tag in others])[0])


def without(solid: int, *tools: int) -> int:
    """Return what is left of a solid after others are taken away; these stay."""
    left, _ = gmsh.model.occ.cut([(3, solid)], [(3, tag) for tag in tools], removeTool=False)
    return only(left)


def drilled(solid: int, *tools: int) -> int:
    """Return what is left of a solid after others are taken away; these are consumed."""
    return only(gmsh.model.occ.cut([(3, solid)], [(3, tag) for tag in tools])[0])


def common(first: int, second: int) -> int:
    """Return what two solids have in common."""
    return only(gmsh.model.occ.intersect([(3, first)], [(3, second)])[0])


def inside(solid: int, others: int) -> int:
    """Return the part of a solid in another one, which stays."""
    found, _ = gmsh.model.occ.intersect([(3, solid)], [(3, others)], removeTool=False)
    return only(found)


def copied(solid: int) -> int:
    """Return a copy of a solid."""
    return only(gmsh.model.occ.copy([(3, solid)]))


def turned_copies(solid: int, count: int) -> list[int]:
    """Return a solid and its copies, evenly round the axis z."""
    tags = [solid, *(copied(solid) for _ in range(count - 1))]
    for number, tag in enumerate(tags):
        gmsh.model.occ.rotate([(3, tag)], *FLAT, 0.0, 0.0, 1.0, number * tau / count)
    return tags


def moved(solid: int, by: Point) -> int:
    """Return a solid after a translation."""
    gmsh.model.occ.translate([(3, solid)], *by)
    return solid


def edges(solid: int, low: Point, high: Point) -> list[int]:
    """Return the edges of a solid that lie in a box."""
    gmsh.model.occ.synchronize()
    found = gmsh.model.getBoundary([(3, solid)], oriented=False)
    found = gmsh.model.getBoundary(found, combined=False, oriented=False)
    tags = sorted({tag for _, tag in found})
    return [tag for tag in tags if within(gmsh.model.getBoundingBox(1, tag), low, high)]


def on_cylinder(curves: Sequence[int], radius: float) -> list[int]:
    """Return the curves all of which lies on a cylinder about the axis z."""
    return [tag for tag in curves if np.abs(radii_along(tag) - radius).max() < 1e-3]


def radii_along(curve: int) -> npt.NDArray[np.float64]:
    """Return the distances from the axis z of some points of a curve."""
    low, high = gmsh.model.getParametrizationBounds(1, curve)
    places = np.linspace(low[0], high[0], 5)
    points = np.reshape(gmsh.model.getValue(1, curve, places), (-1, 3))
    return np.hypot(points[:, 0], points[:, 1])


def within(bounds: Sequence[float], low: Point, high: Point) -> bool:
    """Return whether bounds (lowest, then highest corner) lie in a box, 1 µm of grace."""
    return all(a >= b - 1e-3 for a, b in zip(bounds[:3], low, strict=True)) and all(
        a <= b + 1e-3 for a, b in zip(bounds[3:], high, strict=True)
    )


def filleted(solid: int, curves: Sequence[int], radius: float) -> int:
    """Return a solid with edges rounded.

    Raises:
        ValueError: no edges are given.
    """
    if not curves:
        raise ValueError(f"no edge to be rounded by {radius:g} mm; the box that selects it is off")
    return only(gmsh.model.occ.fillet([solid], list(curves), [radius]))


def rounded_box(low: Point, high: Point, corner: float, roof: float = 0.0) -> int:
    """Return a box whose upright edges are rounded, and those of its top if `roof` is not 0."""
    solid = box(low, high)
    upright: list[int] = []
    for x in (low[0], high[0]):
        for y in (low[1], high[1]):
            upright += edges(solid, (x, y, low[2]), (x, y, high[2]))
    solid = filleted(solid, upright, corner)
    if roof:
        solid = filleted(solid, edges(solid, (low[0], low[1], high[2]), high), roof)
    return solid


def only(found: Sequence[tuple[int, int]]) -> int:
    """Return the tag of the only solid found.

    Raises:
        ValueError: there are several, or none: parameters do not fit each other.
    """
    tags = [tag for dimension, tag in found if dimension == 3]
    if len(tags) != 1:
        raise ValueError(f"{len(tags)} solids where there must be one; mend the parameters")
    return tags[0]
