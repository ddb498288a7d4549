"""Plan of round bodies: a quarter disc in rings, mirrored to a half or a full disc."""

from collections.abc import Sequence

import gmsh
import numpy as np

from castx.meshes.grading import Sizing
from castx.meshes.triangulation import Simplices, mirrored, oriented

SECTORS = ("full", "half", "quarter")


def disc(
    radii: Sequence[float], interface: float, sizing: Sizing, sector: str = "quarter"
) -> Simplices:
    """Triangles of concentric rings; ring i lies between radii i and i + 1 and is region i.

    The quarter x, y >= 0 is meshed, a half (x >= 0) and the full disc are its mirror images.

    Args:
        radii: (rings + 1,) growing, the first may be 0 [m].
        interface: the radius from which the sizes grow [m].
        sizing: wanted sizes.
        sector: "full", "half" (x >= 0) or "quarter".
    """
    if sector not in SECTORS:
        raise ValueError(f"sector must be one of {', '.join(SECTORS)}; got {sector!r}")
    mesh = _quarter(radii, interface, sizing)
    for axis in {"quarter": (), "half": (1,), "full": (1, 0)}[sector]:
        mesh = mirrored(mesh, axis)
    return mesh


def _quarter(radii: Sequence[float], interface: float, sizing: Sizing) -> Simplices:
    previous = gmsh.model.getCurrent()
    gmsh.model.add("quarter disc")
    try:
        surfaces = _draw_rings(radii)
        _set_sizes(radii, interface, sizing)
        gmsh.model.mesh.generate(2)
        return _read_rings(surfaces)
    finally:
        gmsh.model.mesh.removeSizeCallback()
        gmsh.model.remove()
        gmsh.model.setCurrent(previous)


def _draw_rings(radii: Sequence[float]) -> list[int]:
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


def _set_sizes(radii: Sequence[float], interface: float, sizing: Sizing) -> None:
    inside, outside = interface - radii[0], radii[-1] - interface

    def wanted(dim: int, tag: int, x: float, y: float, z: float, given: float) -> float:
        distance = np.hypot(x, y) - interface
        extent = outside if distance > 0 else inside
        return float(sizing.at(np.minimum(abs(distance), extent), extent))

    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    gmsh.model.mesh.setSizeCallback(wanted)


def _read_rings(surfaces: Sequence[int]) -> Simplices:
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
    return Simplices(points, oriented(points, cells), regions, np.arange(len(points)))
