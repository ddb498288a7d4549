"""V8: Cook's membrane, the elastic cases: bending with nearly locked volume.

A tapered panel, 48 long, 44 high at the clamped left edge and 16 at the right one, where it is
sheared. R. D. Cook (1974), Improved two-dimensional finite element, J. Struct. Div. ASCE 100.
There is no closed form: references are converged values, for plane stress 25.16 to 25.21 in the
literature.
"""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

from mpi4py import MPI

import gmsh
import numpy as np

from castx.proof.verification.states import drawn_mesh, nodal, places, states
from castx.proof.verification.verification import (
    FINE,
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

TIP, WIDTH = (48.0, 60.0), 48.0


class Membrane(NamedTuple):
    """Model, constants, shear stress on the right edge and u_y at (48, 60)."""

    model: str
    young: float
    poisson: float
    shear: float
    tip: float


CASES = {
    "plane stress": Membrane("plane-stress", 1.0, 1 / 3, 1 / 16, 25.187),
    "plane strain": Membrane("plane-strain", 70.0, 1 / 3, 6.25, 32.299),
    "nearly incompressible": Membrane("plane-strain", 250.0, 0.4999, 100 / 16, 7.770),
}
INCOMPRESSIBLE = Membrane("plane-strain", 250.0, 0.5, 100 / 16, 7.7695)
"""Beyond what a case file may say, ν = 1/2."""


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


def panel_case(panel: Membrane) -> dict[str, Any]:
    """Return the case of a drawn mesh."""
    elastic = {"young_modulus": panel.young, "poisson_ratio": panel.poisson, "expansion": 0.0}
    return {
        "geometry": {"file": "mesh.msh", "model": panel.model},
        "materials": {"elastic": elastic},
        "bodies": [
            {"name": "membrane", "material": "elastic", "temperature": 20.0,
             "formulation": "mixed"},
        ],
        "boundaries": [
            {"on": "membrane/left", "displacement": {"all": 0.0}},
            {"on": "membrane/right", "traction": [0.0, panel.shear]},
        ],
        "time": {"end": 1.0, "fixed_step": 1.0},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-10},
    }  # fmt: skip


def tip_motion(comm: MPI.Intracomm, panel: Membrane, n: int) -> float:
    """Return u_y at (48, 60) of n × n elements."""
    with drawn_mesh(comm, partial(draw_membrane, n)) as folder:
        for state in states(comm, panel_case(panel), folder):
            distance = np.linalg.norm(places(state, "membrane") - TIP, axis=1)
            moved = nodal(state, "membrane", "displacement")[:, 1]
    return float(moved[np.argmin(distance)])


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Bend the panels and compare their tips."""
    n = round(WIDTH / at.size)
    found = {name: tip_motion(comm, panel, n) for name, panel in CASES.items()}
    answers = tuple(
        Answer.relative(f"tip, {name}", found[name], panel.tip, "", 0.01)
        for name, panel in CASES.items()
    )
    places_of = fine(1.0, float(len(CASES)))[:: (FINE - 1) // (len(CASES) - 1)]
    tips = np.array([panel.tip for panel in CASES.values()])
    curve = Curve("tip", places_of, np.array(list(found.values())), places_of, tips)
    compared = Comparison("plane stress, plane strain, nearly incompressible", "u_y", (curve,))
    return Outcome(answers, max(answer.error for answer in answers), compared)


VERIFICATION = Verification(
    number="V8",
    title="Cook's membrane, elastic",
    formula="u_y(48, 60) = 25.187 in plane stress (E 1, ν 1/3, F 1), 32.299 in plane strain (E 70, "
    "ν 1/3, shear stress 6.25), 7.770 nearly incompressible (E 250, ν 0.4999, F 100)",
    source="R. D. Cook (1974), J. Struct. Div. ASCE 100; converged values",
    run=compare,
    levels=tuple(Resolution(WIDTH / n) for n in (16, 32, 64)),
    quick=tuple(Resolution(WIDTH / n) for n in (16, 32)),
    norm="largest relative error of a tip",
)
