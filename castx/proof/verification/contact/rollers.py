"""V14: Hertz line contact of two cylinders on meshes that do not match.

Two cylinders of radii R1, R2 pressed together by F per length: with 1/R = 1/R1 + 1/R2 and
1/E* = (1 - ν²)/E1 + (1 - ν²)/E2 the half-width is a = √(4 F R/(π E*)) and the pressure
p0 √(1 - (x/a)²) with p0 = 2 F/(π a). K. L. Johnson, Contact Mechanics, section 4.2(c).
"""

from __future__ import annotations

import math
from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np

from castx.arrays import FloatArray
from castx.meshes.model import symmetry_plane
from castx.proof.verification.states import (
    drawn_mesh,
    pair_areas,
    pair_places,
    paired,
    states,
)
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

YOUNG, POISSON = {"upper": 7e9, "lower": 70e9}, 0.33
RADIUS = {"upper": 0.05, "lower": 0.08}
LOAD = 2e5
DEPTH = 4.0
"""Of a slice in space, in elements."""
MODULUS = 1 / ((1 - POISSON**2) * sum(1 / E for E in YOUNG.values()))
CURVATURE = sum(1 / R for R in RADIUS.values())
HALF_WIDTH = math.sqrt(4 * LOAD / (math.pi * CURVATURE * MODULUS))
PEAK = 2 * LOAD / (math.pi * HALF_WIDTH)


def exact_pressure(x: FloatArray) -> FloatArray:
    """Return the contact pressure at distances from the axis [Pa]."""
    return np.asarray(PEAK * np.sqrt(np.maximum(1 - (x / HALF_WIDTH) ** 2, 0.0)))


def draw_rollers(size: float, model: str) -> None:
    """Draw a quarter of each cylinder, fine where they touch, the lower one a little coarser.

    In space they are a slice.
    """
    geo, parts = gmsh.model.geo, []
    for name, sign, factor in (("upper", 1.0, 1.0), ("lower", -1.0, 1.3)):
        R, h = RADIUS[name], factor * size
        # Apart by so much that gmsh takes no points for one; the load closes it.
        y = 0.0 if name == "upper" else -1e-6
        tip = geo.addPoint(0.0, y, 0.0, h)
        middle = geo.addPoint(0.0, y + sign * R, 0.0, R / 8)
        angle = (1.5 if model == "3d" else 3.0) * HALF_WIDTH / R
        near = geo.addPoint(R * math.sin(angle), y + sign * R * (1 - math.cos(angle)), 0.0, h)
        side = geo.addPoint(R, y + sign * R, 0.0, R / 8)
        curves = [geo.addCircleArc(tip, middle, near), geo.addCircleArc(near, middle, side),
                  geo.addLine(side, middle), geo.addLine(middle, tip)]  # fmt: skip
        surface = geo.addPlaneSurface([geo.addCurveLoop(curves)])
        if model == "3d":
            made = geo.extrude([(2, surface)], 0, 0, DEPTH * size, numElements=[1])
            parts.append((name, made[1][1], [tag for _, tag in made[2:]], [surface, made[0][1]]))
        else:
            parts.append((name, surface, curves, []))
    geo.synchronize()
    dimension = 3 if model == "3d" else 2
    for name, inside, sides, ends in parts:
        gmsh.model.addPhysicalGroup(dimension, [inside], name=name)
        gmsh.model.addPhysicalGroup(dimension - 1, sides[:2], name=f"{name} skin")
        gmsh.model.addPhysicalGroup(dimension - 1, [sides[2]], name=f"{name} end")
        if ends:
            gmsh.model.addPhysicalGroup(dimension - 1, ends, name=f"{name} slice")
    axis = [sides[3] for _, _, sides, _ in parts]
    gmsh.model.addPhysicalGroup(dimension - 1, axis, name=symmetry_plane(0))
    gmsh.model.mesh.generate(dimension)


def rollers_case() -> dict[str, Any]:
    """Return the case of a drawn mesh in plane strain."""
    return {
        "geometry": {"file": "mesh.msh", "model": "plane-strain"},
        "materials": {
            name: {"young_modulus": young, "poisson_ratio": POISSON, "expansion": 0.0}
            for name, young in YOUNG.items()
        },
        "bodies": [{"name": name, "material": name, "temperature": 20.0} for name in YOUNG],
        "interfaces": [
            {"bodies": ["upper", "lower"],
             "contact": {"method": "condensed", "pairing": "node-to-face",
                         "surfaces": ["upper skin", "lower skin"]}},
        ],
        "boundaries": [
            {"on": "lower/lower end", "displacement": {"normal": 0.0}},
            {"on": "upper/upper end", "pressure": 0.5 * LOAD / RADIUS["upper"]},
        ],
        "time": {"end": 1.0, "fixed_step": 1.0},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-9},
    }  # fmt: skip


def pressures(comm: MPI.Intracomm, size: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return distance from the axis, pressure and area of all pairs, in order."""
    with drawn_mesh(comm, lambda: draw_rollers(size, "plane-strain")) as folder:
        for state in states(comm, rollers_case(), folder):
            x = pair_places(state, "upper/lower")[:, 0]
            p = paired(state, "upper/lower", "contact_pressure")
            areas = pair_areas(state, "upper/lower")
    order = np.argsort(x)
    return x[order], p[order], areas[order]


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Press the cylinders together and compare."""
    x, p, areas = pressures(comm, at.size)
    # The node on the axis carries half an element; its neighbour makes up for what it misses.
    near = x < 1.5 * at.size
    peak = float(p[near] @ areas[near] / areas[near].sum())
    off = p - exact_pressure(x)
    inside = x < 0.9 * HALF_WIDTH
    wide = x < 1.5 * HALF_WIDTH
    line = fine(0.0, 1.5 * HALF_WIDTH)
    curve = Curve("contact pressure", 1e3 * x[wide], 1e-6 * p[wide], 1e3 * line,
                  1e-6 * exact_pressure(line))  # fmt: skip
    return Outcome(
        (
            Answer.relative("load", float(p @ areas), 0.5 * LOAD, "N/m", 5e-4),
            Answer.relative("pressure on the axis", peak, PEAK, "Pa", 0.015),
            Answer.relative("largest pressure", p.max(), PEAK, "Pa", 0.015),
            Answer.relative("half-width", x[p > 0].max(), HALF_WIDTH, "m", 0.05),
            Answer.difference("pressure, root mean square within 0.9 a",
                              math.sqrt(float(np.mean(off[inside] ** 2))), "Pa", 0.015, PEAK),
        ),
        math.sqrt(float(areas @ off**2) / (HALF_WIDTH * PEAK**2)),
        Comparison("distance from the axis [mm]", "contact pressure [MPa]", (curve,)),
    )  # fmt: skip


VERIFICATION = Verification(
    number="V14",
    title="Hertz line contact of two cylinders, meshes that do not match",
    formula="p = p0 √(1 − (x/a)²), a = √(4 F R/(π E*)), p0 = 2 F/(π a), 1/R = 1/R1 + 1/R2, "
    "1/E* = (1 − ν²)/E1 + (1 − ν²)/E2",
    source="K. L. Johnson, Contact Mechanics, section 4.2(c)",
    run=compare,
    levels=tuple(Resolution(HALF_WIDTH / n) for n in (5, 10, 20)),
    quick=tuple(Resolution(HALF_WIDTH / n) for n in (5, 10)),
    norm="root mean square of the error of the pressure over p0, by area",
)
