"""Cook's membrane: 48 long, 44 high at the clamped left edge, 16 at the right edge."""

from __future__ import annotations

from mpi4py import MPI

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.equilibrium.problem import MechanicalProblem
from tests.elastic_bodies import everywhere, motion, places

TIP = (48.0, 60.0)


def draw_membrane(n: int, quadrilaterals: bool = False, longer: bool = False) -> None:
    """Draw n × n quadrilaterals, or cut each by its shorter or longer diagonal in two triangles."""
    geo = gmsh.model.geo
    points = [geo.addPoint(x, y, 0) for x, y in ((0, 0), (48, 44), (48, 60), (0, 44))]
    edges = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    plate = geo.addPlaneSurface([geo.addCurveLoop(edges)])
    for edge in edges:
        geo.mesh.setTransfiniteCurve(edge, n + 1)
    geo.mesh.setTransfiniteSurface(plate, "Right" if longer else "Left")
    if quadrilaterals:
        geo.mesh.setRecombine(2, plate)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [plate], name="membrane")
    gmsh.model.addPhysicalGroup(1, [edges[1]], name="right")
    gmsh.model.addPhysicalGroup(1, [edges[3]], name="left")
    gmsh.model.mesh.generate(2)


def inner_pressures(comm: MPI.Intracomm, made: MechanicalProblem, n: int) -> FloatArray:
    """Return p at the nodes of the grid from the fourth line behind each edge, on all ranks."""
    x, y = everywhere(comm, places(made, "membrane")).T
    column = np.round(x / 48 * n).astype(int)
    bottom, top = 44 * x / 48, 44 + 16 * x / 48
    row = np.round((y - bottom) / (top - bottom) * n).astype(int)
    p: FloatArray = np.full((n + 1, n + 1), np.nan)
    p[column, row] = everywhere(comm, motion(made, "membrane"))[:, 2]
    return p[4:-4, 4:-4]
