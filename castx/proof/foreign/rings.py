"""A strip of rings one in the other, a row of cells high, as an axisymmetric mesh."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import gmsh


def draw_rings(
    names: Sequence[str], radii: Sequence[float], cells: Sequence[int], height: float
) -> None:
    """Draw rings of quadrilaterals; surfaces inner, outer, bottom and top.

    Args:
        names: of the rings from the axis outwards, (rings,).
        radii: between them, (rings + 1,) [m].
        cells: across each of them, (rings,).
        height: of the strip [m].
    """
    geo = gmsh.model.geo
    low, high = ([geo.addPoint(r, z, 0) for r in radii] for z in (0.0, height))
    upright = [geo.addLine(a, b) for a, b in zip(low, high, strict=True)]
    flat = [[geo.addLine(a, b) for a, b in pairwise(points)] for points in (low, high)]
    for line in upright:
        geo.mesh.setTransfiniteCurve(line, 2)
    for number, (name, count) in enumerate(zip(names, cells, strict=True)):
        below, above = flat[0][number], flat[1][number]
        loop = geo.addCurveLoop([below, upright[number + 1], -above, -upright[number]])
        ring = geo.addPlaneSurface([loop])
        for line in (below, above):
            geo.mesh.setTransfiniteCurve(line, count + 1)
        geo.mesh.setTransfiniteSurface(ring)
        geo.mesh.setRecombine(2, ring)
        geo.synchronize()
        gmsh.model.addPhysicalGroup(2, [ring], name=name)
    for name, lines in (
        ("inner", upright[:1]), ("outer", upright[-1:]), ("bottom", flat[0]), ("top", flat[1]),
    ):  # fmt: skip
        gmsh.model.addPhysicalGroup(1, lines, name=name)
    gmsh.model.mesh.generate(2)
