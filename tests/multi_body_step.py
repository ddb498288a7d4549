"""A STEP assembly of a quarter of a casting with core and chill in a die of two halves, turned.

Its edges and interfaces lean and bend: the core is a cone that leaves the casting and enters both
halves, the casting has a round edge, the die parts along a plane that leans, and the sides of the
chill, which ends on a face of the casting across the parting, lean too.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np

from castx.case.geometry import Geometry
from castx.domain.mesh import CastingMesh, build_mesh
from tests.cad_files import write_cad
from tests.multi_body import ANGLE, AXIS, BODIES, HIGH, turn

CORNER = tuple(1e3 * x for x in HIGH)
"""Corner of the die opposite of the symmetry planes [mm]."""
LEAN = 0.15
"""Slope of the parting along y."""
FACES = {f"plane-{a}": -np.eye(3)[k] for k, a in enumerate("xyz")} | {
    f"far-{a}": np.eye(3)[k] for k, a in enumerate("xyz")
}


def draw(occ: Any) -> list[int]:
    """Draw the solids in millimetres, each by itself, in the order of `BODIES`."""
    casting = occ.addBox(0, 0, 15, 25, 25, 25)
    occ.synchronize()
    around = (24.9, 24.9, 14.9, 25.1, 25.1, 40.1)
    ((_, edge),) = gmsh.model.getEntitiesInBoundingBox(*around, 1)
    ((_, casting),) = occ.fillet([casting], [edge], [8])
    cone = occ.addCone(0, 0, 8, 0, 0, CORNER[2] - 8, 7, 11)
    core = _only(occ.intersect([(3, cone)], [(3, occ.addBox(0, 0, 0, *CORNER))])[0])
    casting = _only(occ.cut([(3, casting)], [(3, core)], removeTool=False)[0])
    chill = _wedge(occ)
    inner = [(3, casting), (3, core), (3, chill)]
    halves = []
    for upper in (False, True):
        half = occ.intersect([(3, occ.addBox(0, 0, 0, *CORNER))], [(3, _half(occ, upper))])[0]
        halves.append(_only(occ.cut(half, inner, removeTool=False)[0]))
    return [casting, core, chill, *halves]


def _half(occ: Any, upper: bool) -> int:
    """Return all that is above or below the parting z = 26 + LEAN y."""
    y, z = 80.0, 80.0 if upper else -80.0
    corners = [(-1, -y, 26 - LEAN * y), (-1, y, 26 + LEAN * y), (-1, y, z), (-1, -y, z)]
    return _prism(occ, corners, 80)


def _wedge(occ: Any) -> int:
    """Return a chill on the face y = 25 of the casting, with sides that lean."""
    return _prism(occ, [(0, 25, 19), (0, 25, 35), (0, 34, 32), (0, 34, 21)], 12)


def _prism(occ: Any, corners: Sequence[tuple[float, float, float]], length: float) -> int:
    points = [occ.addPoint(*corner) for corner in corners]
    edges = [occ.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop(edges)])
    return _only(occ.extrude([(2, face)], length, 0, 0))


def _only(made: list[tuple[int, int]]) -> int:
    ((_, tag),) = [entry for entry in made if entry[0] == 3]
    return int(tag)


def meshed_step(comm: MPI.Intracomm, folder: Path) -> CastingMesh:
    """Return the mesh of the assembly, drawn and turned in CAD, read from its STEP file."""
    file = folder / "assembly.step"
    if comm.rank == 0:
        write_cad(file, draw, BODIES, lambda occ, solids: occ.rotate(solids, 0, 0, 0, *AXIS, ANGLE))
    comm.Barrier()
    geometry = {
        "model": "3d", "file": file, "size": 0.02, "across": 0, "curvature": 8, "growth": 1.0,
        "surfaces": {name: {"normal": list(turn() @ n)} for name, n in FACES.items()},
    }  # fmt: skip
    return build_mesh(Geometry.model_validate(geometry), BODIES, comm)
