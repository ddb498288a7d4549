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

from functools import partial
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest
import ufl
from dolfinx import fem

from castx.forms.kinematics import deviator, strain
from tests.elastic_bodies import (
    STRESS_FREE,
    body,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    motion,
    places,
    problem,
)

EXPANSION = 1e-3
MODELS = {2: "plane-strain", 3: "3d"}
WALLS = {2: ("wall", "far", "bottom"), 3: ("wall", "far", "bottom", "top", "back")}
SIZES = {2: (32, 64), 3: (12, 16)}
RATES = (2.0, 1.0, 1.5)
"""Of u in L2, of u in H1, of p in L2."""
LARGEST_ERRORS = {2: (2e-3, 3e-2, 1.1e-2), 3: (3.5e-2, 1.5e-1, 1.8e-1)}
"""The same on the finest mesh, relative to the exact norms."""


def exact_displacement(x: Any, dimension: int, ops: Any) -> list[Any]:
    up = x[dimension - 1]
    shape = up * (1 - up) ** 2
    for k in range(dimension - 1):
        shape = shape * ops.sin(np.pi * x[k])
    return [shape, -2 * shape, 3 * shape][:dimension]


def exact_pressure(x: Any, dimension: int, ops: Any) -> Any:
    pressure = 1 - x[dimension - 1]
    for k in range(dimension - 1):
        pressure = pressure * ops.cos(np.pi * x[k])
    return pressure


def exact_dilatation(x: np.ndarray, dimension: int) -> np.ndarray:
    """Return ∇·u at points (dimension, n)."""
    up, side = x[-1], np.sin(np.pi * x[:-1])
    total = np.prod(side, axis=0) * (1 - up) * (1 - 3 * up) * (1, -2, 3)[dimension - 1]
    for k in range(dimension - 1):
        slope = np.pi * np.cos(np.pi * x[k]) * np.prod(np.delete(side, k, axis=0), axis=0)
        total = total + (1, -2, 3)[k] * slope * up * (1 - up) ** 2
    return total


def body_force(x: Any, model: str) -> Any:
    """Return -∇·s - ∇p for G = 1."""
    dimension = 3 if model == "3d" else 2
    u = ufl.as_vector(exact_displacement(x, dimension, ufl))
    s = 2 * deviator(strain(u, model, x))
    in_space = ufl.as_tensor([[s[i, j] for j in range(dimension)] for i in range(dimension)])
    return -ufl.div(in_space) - ufl.grad(exact_pressure(x, dimension, ufl))


def relative_errors(comm, dimension: int, n: int, poisson: float, stabilisation: str) -> np.ndarray:
    """Return the errors of u in L2, of u in H1 and of p in L2 over the exact norms."""
    model = MODELS[dimension]
    depth = {"depth": 1.0} if dimension == 3 else {}
    mesh = generated(
        comm, model, "slab", ["casting"], length=1.0, width=1.0, size=1.0 / n, **depth
    )
    young, compressibility = 2 * (1 + poisson), 3 * (1 - 2 * poisson) / (2 * (1 + poisson))
    solid = body(
        elastic(young, poisson, EXPANSION),
        stabilisation=stabilisation,
        body_force=partial(body_force, model=model),
    )
    held = [fixed(wall, "all") for wall in WALLS[dimension]]
    made = problem(mesh, {"casting": solid}, {"casting": held}, tolerance=1e-9)

    def temperature(points: np.ndarray) -> np.ndarray:
        x = points.T
        strained = exact_dilatation(x, dimension)
        strained = strained - compressibility * exact_pressure(x, dimension, np)
        return STRESS_FREE + strained / (3 * EXPANSION)

    heat(made, temperature)
    made.equilibrium.solve(0.0)
    part = made.bodies["casting"]
    x = ufl.SpatialCoordinate(mesh.bodies["casting"].mesh)
    u, p = part.unknowns.displacement(part.solution), part.unknowns.pressure(part.solution)
    u_exact = ufl.as_vector(exact_displacement(x, dimension, ufl))
    p_exact = exact_pressure(x, dimension, ufl)
    errors = (u - u_exact, ufl.grad(u - u_exact), p - p_exact)
    norms = (u_exact, ufl.grad(u_exact), p_exact)
    dx = ufl.Measure("dx", metadata={"quadrature_degree": 4})

    def norm(f: Any) -> float:
        local = fem.assemble_scalar(fem.form(ufl.inner(f, f) * dx))
        return float(np.sqrt(comm.allreduce(local, op=MPI.SUM)))

    return np.array([norm(e) / norm(f) for e, f in zip(errors, norms, strict=True)])


@pytest.mark.serial  # a matter of the mesh; ranks agree in the other tests
@pytest.mark.parametrize("poisson", [0.3, 0.4999, 0.5])
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_convergence(comm, dimension, stabilisation, poisson):
    sizes = np.array(SIZES[dimension])
    errors = [relative_errors(comm, dimension, n, poisson, stabilisation) for n in sizes]
    rates = np.log(errors[0] / errors[1]) / np.log(sizes[1] / sizes[0])
    assert np.all(rates > np.array(RATES) - 0.1), rates
    assert np.all(errors[-1] < LARGEST_ERRORS[dimension]), errors[-1]


@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_hydrostatic_container(comm, dimension, stabilisation):
    """Stiff at one side, 1e3 times softer at the other, in between over one element."""
    n, weight = {2: 16, 3: 6}[dimension], 7e4
    depth = {"depth": 1.0} if dimension == 3 else {}
    mesh = generated(
        comm, MODELS[dimension], "slab", ["casting"], length=1.0, width=1.0, size=1 / n, **depth
    )
    material = elastic([[0.0, 30e9], [1.0, 30e6]], 0.5)
    gravity = (0.0,) * (dimension - 1) + (-weight,)
    filled = body(material, stabilisation=stabilisation, body_force=gravity)
    walls = [fixed(wall) for wall in WALLS[dimension]]
    made = problem(mesh, {"casting": filled}, {"casting": walls})
    heat(made, lambda points: np.where(points[:, 0] > 0.5 - 1e-9, 1.0, 0.0))
    made.equilibrium.solve(0.0)

    moved = everywhere(comm, motion(made, "casting"))
    depth_below = 1 - everywhere(comm, places(made, "casting"))[:, -1]
    np.testing.assert_allclose(moved[:, -1], -weight * depth_below, atol=1e-6 * weight)
    assert np.abs(moved[:, :-1]).max() < 1e-6 * weight / 10e6
