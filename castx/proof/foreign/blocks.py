"""Blocks side by side whose meshes need not match, as a plane mesh of quadrilaterals."""

from __future__ import annotations

from collections.abc import Sequence

import gmsh


def draw_blocks(
    names: Sequence[str],
    edges: Sequence[float],
    height: float,
    cells: Sequence[tuple[int, int]],
) -> None:
    """Draw blocks along x; surfaces NAME-left, NAME-right, NAME-bottom and NAME-top.

    Blocks with the same number of cells upwards, and none else, have equal nodes where they meet.

    Args:
        names: of the blocks, (blocks,).
        edges: left and right edge of each of them, (2 blocks,) [m].
        height: of all [m].
        cells: along x and y of each of them, (blocks,).
    """
    geo = gmsh.model.geo
    for number, (name, (across, up)) in enumerate(zip(names, cells, strict=True)):
        left, right = edges[2 * number : 2 * number + 2]
        corners = [geo.addPoint(x, y, 0.0) for x, y in (
            (left, 0.0), (right, 0.0), (right, height), (left, height))]  # fmt: skip
        lines = [geo.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        for line, count in zip(lines, (across, up, across, up), strict=True):
            geo.mesh.setTransfiniteCurve(line, count + 1)
        block = geo.addPlaneSurface([geo.addCurveLoop(lines)])
        geo.mesh.setTransfiniteSurface(block)
        geo.mesh.setRecombine(2, block)
        geo.synchronize()
        gmsh.model.addPhysicalGroup(2, [block], name=name)
        for line, side in zip(lines, ("bottom", "right", "top", "left"), strict=True):
            gmsh.model.addPhysicalGroup(1, [line], name=f"{name}-{side}")
    gmsh.model.mesh.generate(2)
