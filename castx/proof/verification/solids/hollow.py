"""V10: hollow sphere and cylinder, perfectly plastic, under internal pressure.

R. Hill, The Mathematical Theory of Plasticity (1950), chapter V. Radii a < b, plastic up to c.
Sphere: p = 2 σ_Y ln(c/a) + (2/3) σ_Y (1 - c³/b³), u(b) = σ_Y c³ (1 - ν)/(E b²); plastic σ_r =
-p + 2 σ_Y ln(r/a) and σ_θ = σ_r + σ_Y, elastic σ_θ = (2/3) σ_Y (c³/b³) (1 + b³/(2 r³)).
Cylinder in plane strain, ν = 1/2, k = σ_Y/√3: p = 2 k ln(c/a) + k (1 - c²/b²), u(b) =
3 k c²/(2 E b); plastic σ_r = -p + 2 k ln(r/a) and σ_θ = σ_r + 2 k, elastic σ_θ =
k (c²/b²) (1 + b²/r²).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

from mpi4py import MPI

import gmsh
import numpy as np
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.errors import ConvergenceError
from castx.meshes.model import symmetry_plane
from castx.process.state import State
from castx.proof.verification.states import (
    cellwise,
    centres,
    drawn_mesh,
    nodal,
    places,
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

PLANES = [symmetry_plane(axis) for axis in range(3)]


@dataclass(frozen=True)
class Hollow:
    """Data and exact answers of a hollow body.

    Attributes:
        dimension: 3 for the sphere, 2 for the cylinder.
        inner: radius a [m].
        outer: radius b [m].
        young: E [Pa].
        poisson: ν.
        yield_stress: σ_Y [Pa].
    """

    dimension: int
    inner: float = 0.1
    outer: float = 0.2
    young: float = 210e9
    poisson: float = 0.3
    yield_stress: float = 240e6

    @property
    def _difference(self) -> float:
        """σ_θ - σ_r where it yields."""
        return self.yield_stress * (1.0 if self.dimension == 3 else 2.0 / np.sqrt(3.0))

    def pressure(self, front: float) -> float:
        """Return p for a plastic radius."""
        d, ratio = self.dimension, (front / self.outer) ** self.dimension
        plastic, elastic = (d - 1) * np.log(front / self.inner), (d - 1) / d * (1 - ratio)
        return float(self._difference * (plastic + elastic))

    @property
    def first_yield(self) -> float:
        """Pressure at which the bore yields [Pa]."""
        return self.pressure(self.inner)

    @property
    def limit(self) -> float:
        """Pressure at which all of the wall yields [Pa]."""
        return self.pressure(self.outer)

    def front(self, pressure: float) -> float:
        """Return the plastic radius of a pressure between first yield and limit."""
        return float(brentq(lambda c: self.pressure(c) - pressure, self.inner, self.outer))

    def expansion(self, pressure: float) -> float:
        """Return u(b)."""
        c, b, E = self.front(pressure), self.outer, self.young
        if self.dimension == 3:
            return self.yield_stress * c**3 * (1 - self.poisson) / (E * b**2)
        return 0.75 * self._difference * c**2 / (E * b)

    def hoop_stress(self, pressure: float, radius: FloatArray) -> FloatArray:
        """Return σ_θ at radii."""
        c, b, d = self.front(pressure), self.outer, self.dimension
        flowing = -pressure + (d - 1) * self._difference * np.log(radius / self.inner)
        share = (d - 1) / d * self._difference * (c / b) ** d
        still = share * (1 + (b / radius) ** d / (d - 1))
        return np.where(radius < c, flowing + self._difference, still)


def draw_section(hollow: Hollow, n: int, quadrilaterals: bool = False) -> None:
    """Draw the quarter ring r, z > 0 or x, y > 0 with n cells across the wall."""
    geo, a, b = gmsh.model.geo, hollow.inner, hollow.outer
    centre = geo.addPoint(0, 0, 0)
    points = [geo.addPoint(x, y, 0) for x, y in ((a, 0), (b, 0), (0, b), (0, a))]
    edges = [
        geo.addLine(points[0], points[1]), geo.addCircleArc(points[1], centre, points[2]),
        geo.addLine(points[2], points[3]), geo.addCircleArc(points[3], centre, points[0]),
    ]  # fmt: skip
    wall = geo.addPlaneSurface([geo.addCurveLoop(edges)])
    around = round(n * np.pi / 4 * (a + b) / (b - a))
    for edge, count in zip(edges, (n, around, n, around), strict=True):
        geo.mesh.setTransfiniteCurve(edge, count + 1)
    geo.mesh.setTransfiniteSurface(wall, "AlternateRight")
    if quadrilaterals:
        geo.mesh.setRecombine(2, wall)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [wall], name="wall")
    for edge, name in zip(edges, (PLANES[1], "outside", PLANES[0], "bore"), strict=True):
        gmsh.model.addPhysicalGroup(1, [edge], name=name)
    gmsh.model.mesh.generate(2)


def draw_octant(hollow: Hollow, n: int) -> None:
    """Draw the octant x, y, z > 0 of the sphere in tetrahedra, about n across the wall."""
    occ, a, b = gmsh.model.occ, hollow.inner, hollow.outer
    shell, _ = occ.cut([(3, occ.addSphere(0, 0, 0, b))], [(3, occ.addSphere(0, 0, 0, a))])
    ((_, octant), *_), _ = occ.intersect(shell, [(3, occ.addBox(0, 0, 0, b, b, b))])
    occ.synchronize()
    faces: dict[str, list[int]] = {
        name: [] for name in (*PLANES, "bore", "outside")
    }
    for _, face in gmsh.model.getBoundary([(3, octant)], oriented=False):
        size = np.array(gmsh.model.getBoundingBox(2, face)[3:])
        flat = np.flatnonzero(size < 1e-3 * a)
        curved = "outside" if size.max() > 0.5 * (a + b) else "bore"
        faces[PLANES[flat[0]] if len(flat) else curved].append(face)
    gmsh.model.addPhysicalGroup(3, [octant], name="wall")
    for name, tags in faces.items():
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", (b - a) / n)
    gmsh.model.mesh.generate(3)


MODELS = {3: "axisymmetric", 2: "plane-strain"}
SPHERE, CYLINDER = Hollow(3), Hollow(2, poisson=0.4999)
SPHERE_PRESSURE, CYLINDER_PRESSURE = 197.8132e6, 130.3733e6


def pressed_case(hollow: Hollow, kind: dict[str, Any], time: dict[str, Any]) -> dict[str, Any]:
    """Return the case of a drawn mesh in which the pressure in MPa is the time.

    Args:
        hollow: data.
        kind: formulation of the body.
        time: of the run.
    """
    planes = [f"wall/{PLANES[axis]}" for axis in (1, 0)][: 4 - hollow.dimension]
    steel = {
        "density": 7800.0, "heat_capacity": 500.0, "conductivity": 40.0,
        "young_modulus": hollow.young, "poisson_ratio": hollow.poisson,
        "yield_stress": hollow.yield_stress,
    }  # fmt: skip
    return {
        "geometry": {"file": "mesh.msh", "model": MODELS[hollow.dimension]},
        "materials": {"steel": steel},
        "bodies": [
            {"name": "wall", "material": "steel", "temperature": 20.0,
             "law": "thermo-elasto-plastic", **kind},
        ],
        "boundaries": [
            {"on": "wall/bore", "pressure": [[0.0, 0.0], [1e3, "1 GPa"]]},
            *({"on": plane, "displacement": {"normal": 0}} for plane in planes),
        ],
        "coupling": {"scheme": "mechanical"},
        "time": time,
    }  # fmt: skip


def radial_profile(state: State) -> tuple[FloatArray, FloatArray]:
    """Return radius and hoop stress of the cells."""
    middle, stress = centres(state, "wall"), cellwise(state, "wall", "stress")
    radius = np.linalg.norm(middle, axis=1)
    c, s = middle.T / radius
    return radius, stress[:, 0] * s**2 + stress[:, 1] * c**2 - 2 * stress[:, 3] * s * c


def outer_motion(state: State, hollow: Hollow) -> float:
    """Return u(b) where the outside meets the plane of symmetry."""
    distance = np.linalg.norm(places(state, "wall") - (hollow.outer, 0.0), axis=1)
    return float(nodal(state, "wall", "displacement")[np.argmin(distance), 0])


def collapse(comm: MPI.Intracomm, hollow: Hollow, at: Resolution, pressure: float) -> Any:
    """Raise the pressure until there is no equilibrium.

    Returns:
        u(b), and radius and hoop stress of the cells at the pressure, then the last pressure borne.
    """
    limit, begun = hollow.limit / 1e6, pressure / 1e6
    n = round((hollow.outer - hollow.inner) / at.size)
    thirds = {"end": begun, "first_step": begun / 3, "largest_step": begun / 3,
              "fixed_step": begun / 3}  # fmt: skip
    rising = {"end": 1.1 * limit, "first_step": 0.07 * limit, "largest_step": 0.07 * limit,
              "smallest_step": 1e-3 * limit}  # fmt: skip
    borne = 0.0
    with drawn_mesh(comm, partial(draw_section, hollow, n)) as folder:
        for state in states(comm, pressed_case(hollow, {}, thirds), folder):
            moved, profile = outer_motion(state, hollow), radial_profile(state)
        try:
            for state in states(comm, pressed_case(hollow, {}, rising), folder):
                borne = 1e6 * state.time
        except ConvergenceError:  # the collapse
            pass
    return moved, profile, borne


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Press sphere and cylinder to a pressure between first yield and limit, then to collapse."""
    answers, curves, norm = [], [], 0.0
    for what, hollow, pressure in (
        ("sphere", SPHERE, SPHERE_PRESSURE), ("cylinder", CYLINDER, CYLINDER_PRESSURE),
    ):  # fmt: skip
        moved, (radius, hoop), borne = collapse(comm, hollow, at, pressure)
        scale = hollow.yield_stress
        error = np.abs(hoop - hollow.hoop_stress(pressure, radius))
        answers += [
            Answer.relative(f"expansion of the {what}", moved, hollow.expansion(pressure), "m",
                            0.01),
            Answer.difference(f"hoop stress in the {what}", error.max(), "Pa", 0.03, scale),
            Answer.relative(f"collapse of the {what}", borne, hollow.limit, "Pa", 0.015),
        ]  # fmt: skip
        norm = max(norm, float(np.sqrt(np.mean(error**2))) / scale)
        line = fine(hollow.inner, hollow.outer)
        order = np.argsort(radius)
        curves.append(Curve(what, radius[order], 1e-6 * hoop[order], line,
                            1e-6 * hollow.hoop_stress(pressure, line)))  # fmt: skip
    return Outcome(
        tuple(answers), norm, Comparison("radius [m]", "hoop stress [MPa]", tuple(curves))
    )


VERIFICATION = Verification(
    number="V10",
    title="Hollow sphere and cylinder, plastic",
    formula="sphere p = 2 σ_Y ln(c/a) + (2/3) σ_Y (1 − c³/b³), u(b) = σ_Y c³ (1 − ν)/(E b²); "
    "cylinder p = 2 k ln(c/a) + k (1 − c²/b²), u(b) = 3 k c²/(2 E b), k = σ_Y/√3; c the plastic "
    "radius",
    source="R. Hill, The Mathematical Theory of Plasticity (1950), chapter V",
    run=compare,
    levels=(Resolution(0.1 / 8), Resolution(0.1 / 16)),
    quick=(Resolution(0.1 / 8), Resolution(0.1 / 16)),
    norm="root mean square of the error of the hoop stress over the yield stress",
)
