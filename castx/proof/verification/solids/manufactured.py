"""V7: manufactured solutions of the mixed u/p elements, and the hydrostatic container.

A displacement that vanishes on all faces of the unit square or cube but the upper one, which is
free of traction, and an independent pressure:
    u = sin(πx) y (1 - y)² (1, -2),  p = (1 - y) cos(πx)   (in the cube with sin(πx) sin(πy) and z),
with G = 1 for every ν. The body force is b = -∇·s - ∇p, the volumetric thermal strain
e^θ = ∇·u - p/K. P. J. Roache (2002), Code verification by the method of manufactured solutions.
Linear u/p elements: u converges with order 2 in L2 and 1 in H1, p with order 1 or better.

The container: rigid, frictionless, open on top, with 1/K = 0 under gravity ρg: u = 0 and p = -ρg
times the depth, however stiff its parts.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from mpi4py import MPI

import numpy as np
import ufl
from dolfinx import fem

from castx.arrays import FloatArray
from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.equilibrium.building import MechanicsSettings
from castx.equilibrium.problem import MechanicalProblem
from castx.forms.kinematics import deviator, strain
from castx.materials.description import MaterialDescription
from castx.materials.material import Material
from castx.mechanics.constitutive.law import Law
from castx.mechanics.description import MechanicalBody
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.proof.verification.verification import (
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)
from castx.tables import Table

EXPANSION, STRESS_FREE = 1e-3, 20.0
MODELS = {2: "plane-strain", 3: "3d"}
WALLS = {2: ("wall", "far", "bottom"), 3: ("wall", "far", "bottom", "top", "back")}
WEIGHT = 7e4
"""ρg of the container [N/m³]."""
LARGEST_ERRORS = {2: (2e-3, 3e-2, 1.1e-2), 3: (3.5e-2, 1.5e-1, 1.8e-1)}
"""Of u in L2 and H1 and of p in L2 over the exact norms, at 64 elements and in space at 16."""


def exact_displacement(x: Any, dimension: int, ops: Any) -> list[Any]:
    """Return u at a place, by numpy or UFL."""
    up = x[dimension - 1]
    shape = up * (1 - up) ** 2
    for k in range(dimension - 1):
        shape = shape * ops.sin(np.pi * x[k])
    return [shape, -2 * shape, 3 * shape][:dimension]


def exact_pressure(x: Any, dimension: int, ops: Any) -> Any:
    """Return p at a place, by numpy or UFL."""
    pressure = 1 - x[dimension - 1]
    for k in range(dimension - 1):
        pressure = pressure * ops.cos(np.pi * x[k])
    return pressure


def exact_dilatation(x: FloatArray, dimension: int) -> FloatArray:
    """Return ∇·u at points (dimension, n)."""
    up, side = x[-1], np.sin(np.pi * x[:-1])
    total = np.prod(side, axis=0) * (1 - up) * (1 - 3 * up) * (1, -2, 3)[dimension - 1]
    for k in range(dimension - 1):
        slope = np.pi * np.cos(np.pi * x[k]) * np.prod(np.delete(side, k, axis=0), axis=0)
        total = total + (1, -2, 3)[k] * slope * up * (1 - up) ** 2
    return np.asarray(total)


def body_force(x: Any, model: str) -> Any:
    """Return -∇·s - ∇p for G = 1."""
    dimension = 3 if model == "3d" else 2
    u = ufl.as_vector(exact_displacement(x, dimension, ufl))
    s = 2 * deviator(strain(u, model, x))
    in_space = ufl.as_tensor([[s[i, j] for j in range(dimension)] for i in range(dimension)])
    return -ufl.div(in_space) - ufl.grad(exact_pressure(x, dimension, ufl))


def elastic(young: Any, poisson: float, expansion: float = 0.0) -> Material:
    """Return a thermo-elastic material, incompressible at ν = 1/2, which no case may ask for."""
    read = MaterialDescription.read(
        {"density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0, "young_modulus": young,
         "poisson_ratio": min(poisson, 0.4999), "expansion": expansion}
    )  # fmt: skip
    ratio = {"poisson_ratio": Table.constant(poisson)}
    return Material("manufactured", read.model_copy(update=ratio))


def solved(
    comm: MPI.Intracomm,
    dimension: int,
    size: float,
    material: Material,
    temperature: Callable[[FloatArray], FloatArray],
    held: str,
    tolerance: float = 1e-12,
    **description: Any,
) -> MechanicalProblem:
    """Return the equilibrium of the unit square or cube under a body force; collective.

    Args:
        comm: the ranks.
        dimension: 2 or 3.
        size: of the elements [m].
        material: of the body.
        temperature: at points (n, dimension) [°C].
        held: "all" or "normal" displacements of the walls.
        tolerance: of the mechanics.
        description: what else a `MechanicalBody` is given.
    """
    depth = {"depth": 1.0} if dimension == 3 else {}
    geometry = {"generator": "slab", "model": MODELS[dimension], "length": 1.0, "width": 1.0,
                "size": size, **depth}  # fmt: skip
    mesh = build_mesh(Geometry.model_validate(geometry), ["casting"], comm)
    body = MechanicalBody(Law(material, STRESS_FREE), **description)
    walls = [SurfaceDisplacement(wall, held, Table.constant(0.0)) for wall in WALLS[dimension]]
    settings = MechanicsSettings(tolerance=tolerance, linear="direct")
    made = MechanicalProblem(mesh, {"casting": body}, {"casting": walls}, [], settings)
    part = made.bodies["casting"]
    points = part.mesh.nodes.tabulate_dof_coordinates()[:, :dimension]
    part.update_state(temperature(points), np.ones(len(points)), 1.0)
    made.equilibrium.solve(0.0)
    return made


def manufactured(
    comm: MPI.Intracomm, dimension: int, size: float, poisson: float, stabilisation: str
) -> MechanicalProblem:
    """Return the equilibrium whose solution is known."""
    young, compressibility = 2 * (1 + poisson), 3 * (1 - 2 * poisson) / (2 * (1 + poisson))

    def temperature(points: FloatArray) -> FloatArray:
        x = points.T
        strained = exact_dilatation(x, dimension)
        strained = strained - compressibility * exact_pressure(x, dimension, np)
        return np.asarray(STRESS_FREE + strained / (3 * EXPANSION))

    return solved(
        comm, dimension, size, elastic(young, poisson, EXPANSION), temperature, "all", 1e-9,
        stabilisation=stabilisation, body_force=partial(body_force, model=MODELS[dimension]),
    )  # fmt: skip


def relative_errors(made: MechanicalProblem) -> FloatArray:
    """Return the errors of u in L2, of u in H1 and of p in L2 over the exact norms."""
    part = made.bodies["casting"]
    mesh, dimension = part.mesh.mesh, part.dimension
    x = ufl.SpatialCoordinate(mesh)
    u, p = part.unknowns.displacement(part.solution), part.unknowns.pressure(part.solution)
    u_exact = ufl.as_vector(exact_displacement(x, dimension, ufl))
    p_exact = exact_pressure(x, dimension, ufl)
    errors = (u - u_exact, ufl.grad(u - u_exact), p - p_exact)
    norms = (u_exact, ufl.grad(u_exact), p_exact)
    dx = ufl.Measure("dx", metadata={"quadrature_degree": 4})

    def norm(f: Any) -> float:
        local = fem.assemble_scalar(fem.form(ufl.inner(f, f) * dx))
        return float(np.sqrt(mesh.comm.allreduce(local, op=MPI.SUM)))

    return np.array([norm(e) / norm(f) for e, f in zip(errors, norms, strict=True)])


def container(
    comm: MPI.Intracomm, dimension: int, size: float, stabilisation: str
) -> MechanicalProblem:
    """Return a container filled with a weight, stiff at one side and 1e3 times softer at another.

    In between it changes over one element.
    """
    gravity = (0.0,) * (dimension - 1) + (-WEIGHT,)
    return solved(
        comm, dimension, size, elastic([[0.0, 30e9], [1.0, 30e6]], 0.5),
        lambda points: np.where(points[:, 0] > 0.5 - 1e-9, 1.0, 0.0), "normal",
        stabilisation=stabilisation, body_force=gravity,
    )  # fmt: skip


def nodal_answers(made: MechanicalProblem) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return places, displacements and pressures of the nodes of all ranks."""
    part = made.bodies["casting"]
    owned = part.space.dofmap.index_map.size_local
    points = part.mesh.nodes.tabulate_dof_coordinates()[:owned, : part.dimension]
    values = part.solution.x.array.reshape(-1, part.block_size)[:owned]
    pressures = values[:, part.unknowns.pressure_component] * part.unknowns.pressure_scale
    rows = np.column_stack([points, values[:, : part.dimension], pressures])
    rows = np.concatenate(part.mesh.mesh.comm.allgather(rows))
    return rows[:, : part.dimension], rows[:, part.dimension : -1], rows[:, -1]


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Solve in the plane for three Poisson ratios, in space for one, and fill the container."""
    cases = [(2, nu, how, at.size) for nu in (0.3, 0.4999, 0.5) for how in ("osgs", "gls")]
    cases.append((3, 0.5, "osgs", 4 * at.size))
    answers, worst = [], 0.0
    for dimension, poisson, how, size in cases:
        made = manufactured(comm, dimension, size, poisson, how)
        errors = relative_errors(made)
        elements = "triangles" if dimension == 2 else "tetrahedra"
        names = ("u in L2", "u in H1", "p in L2")
        answers += [
            Answer.difference(f"{name}, {elements}, ν = {poisson:g}, {how}", error, "relative",
                              largest)
            for name, error, largest in zip(names, errors, LARGEST_ERRORS[dimension], strict=True)
        ]  # fmt: skip
        worst = max(worst, float(errors[1]) if dimension == 2 else 0.0)
        if (dimension, poisson, how) == (2, 0.5, "osgs"):
            places, _, pressures = nodal_answers(made)
    for how in ("osgs", "gls"):
        points, moved, filled = nodal_answers(container(comm, 2, 1 / 16, how))
        off = np.abs(filled + WEIGHT * (1 - points[:, -1])).max()
        answers += [
            Answer.difference(f"pressure of the container, {how}", off, "Pa", 1e-6, WEIGHT),
            Answer.difference(f"displacement of the container, {how}", np.abs(moved).max(), "m",
                              1e-6 * WEIGHT / 10e6),
        ]  # fmt: skip
    line = fine(0.0, 1.0)
    curves = []
    for height in (0.25, 0.5):
        there = np.abs(places[:, 1] - height) < 1e-9
        order = np.argsort(places[there, 0])
        exact = exact_pressure(np.stack([line, np.full_like(line, height)]), 2, np)
        curves.append(Curve(f"y = {height:g}", places[there, 0][order], pressures[there][order],
                            line, exact))  # fmt: skip
    compared = Comparison("x", "pressure, triangles, ν = 0.5, osgs", tuple(curves))
    return Outcome(tuple(answers), worst, compared)


VERIFICATION = Verification(
    number="V7",
    title="Manufactured solutions of u/p elements, and a container filled with a weight",
    formula="u = sin(πx) y (1 − y)² (1, −2), p = (1 − y) cos(πx), b = −∇·s − ∇p, e^θ = ∇·u − p/K; "
    "in the container u = 0, p = −ρg · depth",
    source="P. J. Roache (2002), Code verification by the method of manufactured solutions",
    run=compare,
    levels=tuple(Resolution(1 / n) for n in (16, 32, 64)),
    quick=tuple(Resolution(1 / n) for n in (32, 64)),
    norm="largest relative error of u in H1, triangles",
)
