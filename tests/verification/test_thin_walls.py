"""Walls with one cell across: bending by a force and by temperature, in quadratic displacements.

A cantilever of length L and height h under an end shear F per width has the tip F L³/(3 E I) plus
the shear of 6/5 F L/(G h); in plane strain E/(1 − ν²) stands for E. Its clamped end holds ν too,
less than a percent at L/h = 20. A plate whose temperature differs by ΔT across its height bends to
the curvature α ΔT/h, (1 + ν) times as much in plane strain, without stress where it is free.
Linear displacements are 54 % too stiff.
"""

from __future__ import annotations

import numpy as np
import pytest
from ufl import SpatialCoordinate

from castx.equilibrium.problem import MechanicalProblem
from tests.elastic_bodies import (
    body,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    motion,
    places,
    problem,
    pulled,
    stresses,
)

LENGTH, HEIGHT, WIDE = 0.02, 0.001, 0.01
YOUNG, POISSON, EXPANSION, DIFFERENCE = 70e9, 0.33, 2e-5, 100.0
MODELS = ("plane-strain", "plane-stress", "3d")


def wall(
    comm, model: str, supports, size: float = HEIGHT, wide: float = HEIGHT, **description
) -> MechanicalProblem:
    """Return a wall of cells as large as it is high, or of a size."""
    depth = {"depth": wide} if model == "3d" else {}
    mesh = generated(comm, model, "slab", ["casting"], length=LENGTH, width=HEIGHT, size=size,
                     **depth)  # fmt: skip
    metal = elastic(YOUNG, POISSON, EXPANSION)
    described = body(metal, formulation="taylor-hood", **description)
    return problem(mesh, {"casting": described}, {"casting": supports}, tolerance=1e-9)


def deflection(comm, made: MechanicalProblem, height: float) -> float:
    """Return the mean of u_y at the end, less that at the wall, at one height."""
    points = everywhere(comm, places(made, "casting"))
    moved = everywhere(comm, motion(made, "casting"))[:, 1]
    level = np.abs(points[:, 1] - height) < 1e-9
    ends = [level & (np.abs(points[:, 0] - x) < 1e-9) for x in (0.0, LENGTH)]
    return float(moved[ends[1]].mean() - moved[ends[0]].mean())


@pytest.mark.ranks
@pytest.mark.parametrize("model", MODELS)
def test_a_cantilever_bends_with_one_cell_across(comm, model):
    shear = 1e5
    traction = (0.0, shear, 0.0) if model == "3d" else (0.0, shear)
    made = wall(comm, model, [fixed("wall", "all")], loads=(pulled("far", *traction),))
    made.equilibrium.solve(0.0)
    stiff = YOUNG / (1 - POISSON**2) if model == "plane-strain" else YOUNG
    bending = shear * HEIGHT * LENGTH**3 / (3 * stiff * HEIGHT**3 / 12)
    exact = bending + 1.2 * shear * LENGTH / (YOUNG / (2 * (1 + POISSON)))
    assert deflection(comm, made, 0.0) == pytest.approx(exact, rel=0.01)


@pytest.mark.ranks
@pytest.mark.parametrize("model", MODELS)
def test_a_plate_bends_by_its_temperature_without_stress(comm, model):
    made = wall(comm, model, [fixed("wall")])
    heat(made, lambda x: 20.0 + DIFFERENCE * (x[:, 1] / HEIGHT - 0.5))
    made.equilibrium.solve(0.0)
    held = 1 + POISSON if model == "plane-strain" else 1
    exact = -EXPANSION * DIFFERENCE / HEIGHT * held * LENGTH**2 / 2
    assert deflection(comm, made, 0.0) == pytest.approx(exact, rel=1e-6)
    hindered = YOUNG * EXPANSION * DIFFERENCE
    assert np.abs(stresses(comm, made, "casting")[:, :2]).max() < 1e-6 * hindered


@pytest.mark.serial
@pytest.mark.parametrize("model", MODELS[1:])
def test_two_cells_hold_the_stress_by_a_parabola(comm, model):
    """All that two lines have of a parabola: 15/16 of its product with the exact one."""
    made = wall(comm, model, [fixed("wall")], HEIGHT / 2, WIDE)
    heat(made, lambda x: 20.0 + DIFFERENCE * 4 * x[:, 1] / HEIGHT * (1 - x[:, 1] / HEIGHT))
    made.equilibrium.solve(0.0)
    part = made.bodies["casting"]
    places = part.points.evaluate(part.points.expression(SpatialCoordinate(part.mesh.mesh)))
    # Ends and, in space, sides bulge.
    inner = np.abs(places[:, 0] - LENGTH / 2) < LENGTH / 4
    if model == "3d":
        inner &= np.abs(places[:, 2] - WIDE / 2) < WIDE / 4
    hot = 1 - np.abs(2 * places[inner, 1] / HEIGHT - 1)
    pulled_by = YOUNG * EXPANSION * DIFFERENCE * (0.5 - hot)
    deviator = pulled_by / (1 - POISSON) / 3 if model == "3d" else pulled_by * 2 / 3
    found = part.material.response.stress[inner, 0]
    np.testing.assert_allclose(found, deviator, atol=0.01 * np.abs(deviator).max())


@pytest.mark.ranks
@pytest.mark.parametrize("poisson", [POISSON, 0.4999])
def test_two_levels_take_as_many_iterations_on_finer_meshes(comm, poisson):
    """Of beams with one and three cells across, nearly incompressible ones too."""
    taken = []
    for size in (0.01, 0.01 / 3):
        mesh = generated(comm, "3d", "slab", ["casting"], length=0.03, width=0.01, depth=0.01,
                         size=size)  # fmt: skip
        found = []
        for linear in ("iterative", "direct"):
            described = body(
                elastic(YOUNG, poisson), formulation="taylor-hood",
                loads=(pulled("far", 0.0, 1e5, 0.0),),
            )  # fmt: skip
            held = {"casting": [fixed("wall", "all")]}
            made = problem(mesh, {"casting": described}, held, linear=linear, tolerance=1e-6)
            solves = made.equilibrium.solve(0.0).linear_solves
            found.append(everywhere(comm, motion(made, "casting"))[:, :3])
            if linear == "iterative":
                taken.append(max(solves))
        assert np.abs(found[0] - found[1]).max() < 1e-6 * np.abs(found[1]).max()
    assert 5 < taken[1] < 40 and abs(taken[1] - taken[0]) <= 10
