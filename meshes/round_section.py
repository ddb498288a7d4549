"""Plan of round bodies: a quarter disc in rings, mirrored to a half or a full disc.

gmsh is imported where it is used: generators are declared, and cases checked, without it.
"""

from collections.abc import Sequence

import numpy as np

from castx.meshes.grading import Sizing
from castx.meshes.linear_mesh import QUADRILATERALS, SIMPLICES, LinearMesh, mirrored, oriented
from castx.meshes.o_grid import Radii, quarter_o_grid

SECTORS = ("full", "half", "quarter")


def disc(
    radii: Radii, sizing: Sizing, sector: str = "quarter", cells: str = SIMPLICES
) -> LinearMesh:
    """Return a mesh of two concentric rings; the inner one is region 0, the outer one 1.

    The quarter x, y >= 0 is meshed, a half (x >= 0) and the full disc are its mirror images.

    Args:
        radii: of the bore, which may be 0, of the interface and of the outside [m].
        sizing: wanted sizes; they grow away from the interface.
        sector: "full", "half" (x >= 0) or "quarter".
        cells: "simplices" or "quadrilaterals".
    """
    if sector not in SECTORS:
        raise ValueError(f"sector must be one of {', '.join(SECTORS)}; got {sector!r}")
    if cells == QUADRILATERALS:
        mesh = quarter_o_grid(radii, sizing)
    else:
        mesh = _quarter_triangles(radii, sizing)
    for axis in {"quarter": (), "half": (1,), "full": (1, 0)}[sector]:
        mesh = mirrored(mesh, axis)
    return mesh


def _quarter_triangles(radii: Radii, sizing: Sizing) -> LinearMesh:
    import gmsh

    previous = gmsh.model.getCurrent()
    gmsh.model.add("quarter disc")
    try:
        surfaces = _draw_rings(radii)
        _set_sizes(radii, sizing)
        gmsh.model.mesh.generate(2)
        return _read_rings(surfaces)
    finally:
        gmsh.model.mesh.removeSizeCallback()
        gmsh.model.remove()
        gmsh.model.setCurrent(previous)


def _draw_rings(radii: Radii) -> list[int]:
    import gmsh

    geo = gmsh.model.geo
    centre = geo.addPoint(0, 0, 0)
    on_x = [geo.addPoint(r, 0, 0) if r > 0 else centre for r in radii]
    on_y = [geo.addPoint(0, r, 0) if r > 0 else centre for r in radii]
    arcs = [
        geo.addCircleArc(a, centre, b) if a != b else 0 for a, b in zip(on_x, on_y, strict=True)
    ]
    surfaces = []
    for i in range(len(radii) - 1):
        along_x = geo.addLine(on_x[i], on_x[i + 1])
        along_y = geo.addLine(on_y[i], on_y[i + 1])
        inner = [-arcs[i]] if arcs[i] else []
        surfaces.append(
            geo.addPlaneSurface([geo.addCurveLoop([along_x, arcs[i + 1], -along_y, *inner])])
        )
    geo.synchronize()
    return surfaces


def _set_sizes(radii: Radii, sizing: Sizing) -> None:
    bore, interface, outer = radii
    inside, outside = interface - bore, outer - interface

    def wanted(dim: int, tag: int, x: float, y: float, z: float, given: float) -> float:
        distance = np.hypot(x, y) - interface
        extent = outside if distance > 0 else inside
        return float(sizing.at(np.minimum(abs(distance), extent), extent))

    import gmsh

    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    gmsh.model.mesh.setSizeCallback(wanted)


def _read_rings(surfaces: Sequence[int]) -> LinearMesh:
    import gmsh

    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = coordinates.reshape(-1, 3)[:, :2].copy()
    index = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    index[tags] = np.arange(len(tags))
    parts = [
        index[gmsh.model.mesh.getElementsByType(2, surface)[1]].reshape(-1, 3)
        for surface in surfaces
    ]
    used, cells = np.unique(np.concatenate(parts), return_inverse=True)
    cells = cells.reshape(-1, 3)
    points = points[used]
    points[np.abs(points) < 1e-12 * points.max()] = 0.0
    regions = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return LinearMesh(points, oriented(points, cells), regions, np.arange(len(points)))
