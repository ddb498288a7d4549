"""V18: an elastic cube cut by an inclined plane closes when heated and opens when cooled.

The x faces are held in x, the y faces in y, the z faces free. Heated by ΔT above the stress-free
temperature each part is in the state σ_xx = σ_yy = -E α ΔT/(1 - ν), σ_zz = 0 (Timoshenko and
Goodier, Theory of Elasticity, 3rd ed., section 149: a plate that cannot expand in its plane). It is
hydrostatic in the x-y plane, so that every plane with its normal there carries this pressure and no
shear. Cooled below that temperature the parts let go of each other.
"""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np

from castx.proof.verification.states import cellwise, drawn_mesh, paired, states
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
)

SIDE, LAMBDA, MU, EXPANSION = 0.1, 52e9, 26e9, 2.2e-5
YOUNG = MU * (3 * LAMBDA + 2 * MU) / (LAMBDA + MU)
POISSON = LAMBDA / (2 * (LAMBDA + MU))
LOW, HIGH = 0.35 * SIDE, 0.6 * SIDE
"""Where the cut meets the faces y = 0 and y = SIDE."""
EXCESS = (10.0, 4.0, -0.5, -1.0, -30.0)
"""Temperatures above the stress-free one after each second [K]."""
FREE = 300.0


def contact_pressure(excess: float) -> float:
    """Return E α ΔT/(1 - ν), zero below the stress-free temperature [Pa]."""
    return max(YOUNG * EXPANSION * excess / (1 - POISSON), 0.0)


def draw_cut_cube(size: float = SIDE / 5) -> None:
    """Two prisms in z on quadrilaterals left and right of the cut."""
    geo = gmsh.model.geo
    corners = ((0, 0), (LOW, 0), (SIDE, 0), (SIDE, SIDE), (HIGH, SIDE), (0, SIDE))
    points = [geo.addPoint(x, y, 0.0, size) for x, y in corners]
    cut = geo.addLine(points[1], points[4])
    edges = [geo.addLine(points[i], points[(i + 1) % 6]) for i in range(6)]
    plans = ((edges[0], cut, edges[4], edges[5]), (edges[1], edges[2], edges[3], -cut))
    extruded = [
        geo.extrude([(2, geo.addPlaneSurface([geo.addCurveLoop(list(plan))]))], 0, 0, SIDE)
        for plan in plans
    ]
    geo.synchronize()
    names = (("y-low", None, "y-high", "x-low"), ("y-low", "x-high", "y-high", None))
    surfaces: dict[str, list[int]] = {}
    for part, entities, sides in zip(("left", "right"), extruded, names, strict=True):
        gmsh.model.addPhysicalGroup(3, [entities[1][1]], name=part)
        for name, (_, surface) in zip(sides, entities[2:], strict=True):
            if name is not None:
                surfaces.setdefault(name, []).append(surface)
    for name, tags in surfaces.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    gmsh.model.mesh.generate(3)


def cube_case() -> dict[str, Any]:
    """Return the case of a drawn mesh; nothing holds it in z but automatic supports."""
    held = {"left": ("x-low", "y-low", "y-high"), "right": ("x-high", "y-low", "y-high")}
    history = [[0.0, FREE], *([k + 1.0, FREE + excess] for k, excess in enumerate(EXCESS))]
    return {
        "geometry": {"file": "mesh.msh", "model": "3d"},
        "materials": {
            "metal": {"young_modulus": YOUNG, "poisson_ratio": POISSON, "expansion": EXPANSION,
                      "stress_free": FREE},
        },
        "bodies": [
            {"name": name, "material": "metal", "temperature_history": history} for name in held
        ],
        "interfaces": [{"bodies": ["left", "right"], "contact": {"method": "condensed"}}],
        "boundaries": [
            {"on": f"{name}/{face}", "displacement": {"normal": 0.0}}
            for name, faces in held.items()
            for face in faces
        ],
        "time": {"end": float(len(EXCESS)), "fixed_step": 1.0, "first_step": 1.0,
                 "largest_step": 1.0},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-11},
    }  # fmt: skip


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Heat the cube, then cool it through the stress-free temperature."""
    rows, off, sheared, pushed, least = [], 0.0, 0.0, 0.0, np.inf
    with drawn_mesh(comm, lambda: draw_cut_cube(at.size)) as folder:
        for state in states(comm, cube_case(), folder):
            if state.step == 0:
                continue
            excess = EXCESS[round(state.time) - 1]
            exact = contact_pressure(excess)
            pressures = paired(state, "left/right", "contact_pressure")
            rows.append((excess, pressures.mean()))
            if excess < 0:
                pushed = max(pushed, float(pressures.max()))
                least = min(least, float(paired(state, "left/right", "gap").min()))
                continue
            off = max(off, float(np.abs(pressures / exact - 1).max()))
            for name in ("left", "right"):
                shear = cellwise(state, name, "stress")[:, 3:]
                sheared = max(sheared, float(np.abs(shear).max()) / exact)
    heated, found = np.array(rows).T
    order = np.argsort(heated)
    line = np.array([EXCESS[-1], 0.0, EXCESS[0]])
    exact_line = 1e-6 * np.array([contact_pressure(value) for value in line])
    curve = Curve("contact pressure", heated[order], 1e-6 * found[order], line, exact_line)
    return Outcome(
        (
            Answer.difference("pressure when heated", off, "relative", 1e-8),
            Answer.difference("shear over the pressure", sheared, "", 1e-8),
            Answer.difference("pressure when cooled", pushed, "Pa", 1e-9),
            Answer.difference("overlap when cooled", max(-least, 0.0), "m", 1e-12),
        ),
        off,
        Comparison("temperature above the stress-free one [K]", "contact pressure [MPa]", (curve,)),
    )


VERIFICATION = Verification(
    number="V18",
    title="A cut cube that closes when heated and opens when cooled",
    formula="p = E α ΔT/(1 − ν), no shear; open below the stress-free temperature",
    source="S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed., section 149",
    run=compare,
    levels=(Resolution(SIDE / 5),),
    quick=(Resolution(SIDE / 5),),
    refined="nothing",
)
