"""V14: Hertz line contact of two cylinders on meshes that do not match.

Two cylinders of radii R1, R2 pressed together by F per length: with 1/R = 1/R1 + 1/R2 and
1/E* = (1 - ν²)/E1 + (1 - ν²)/E2 the half-width is a = √(4 F R/(π E*)) and the pressure
p0 √(1 - (x/a)²) with p0 = 2 F/(π a). K. L. Johnson, Contact Mechanics, section 4.2(c).
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.choice import Contact
from castx.proof.verification.contact.rollers import (
    DEPTH,
    HALF_WIDTH,
    LOAD,
    PEAK,
    POISSON,
    RADIUS,
    YOUNG,
    draw_rollers,
    exact_pressure,
)
from tests.contact_methods import AT_ONCE, sharp
from tests.elastic_bodies import body, drawn, elastic, everywhere, fixed, problem, pushed

pytestmark = pytest.mark.sampled


def touching(
    comm, folder: Path, method: str, elements: int, model: str = "plane-strain",
    forms: tuple[str, str] = ("", ""),
):  # fmt: skip
    """Return the solved problem with so many elements on the half-width.

    Args:
        comm: the ranks.
        folder: for the mesh.
        method: of the contact.
        elements: on the half-width.
        model: geometric model.
        forms: formulations of the upper and the lower cylinder, linear displacements unless given.
    """
    size = HALF_WIDTH / elements
    names = list(YOUNG)
    mesh = drawn(comm, model, names, folder / "hertz.msh", lambda: draw_rollers(size, model))
    linear = "displacement" if model == "3d" else "mixed"
    end = pushed("upper end", 0.5 * LOAD / RADIUS["upper"])
    loads = {"upper": (end,), "lower": ()}
    bodies = {
        name: body(elastic(E, POISSON), loads=loads[name], formulation=form or linear)
        for (name, E), form in zip(YOUNG.items(), forms, strict=True)
    }
    rule = Pairing(kind="node-to-face", surfaces=("upper skin", "lower skin"))
    held = {"upper": [], "lower": [fixed("lower end")]}
    for name in names if model == "3d" else []:
        held[name].append(fixed(f"{name} slice"))
    made = problem(
        mesh, bodies, held, [Contact("upper", "lower", method, pairing=rule)],
        tolerance=1e-9,
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    return made


def profile(comm, made):
    """Return the distance from the axis, pressure and area of all lines of pairs, in order."""
    x = everywhere(comm, made.pairs[0].points[:, 0])
    areas = everywhere(comm, made.pairs[0].areas)
    force = areas * everywhere(comm, made.contact_states()[0].pressure)
    line = np.unique(np.round(x / HALF_WIDTH, 6), return_inverse=True)[1].ravel()
    count = np.bincount(line)
    area = np.bincount(line, areas)
    return np.bincount(line, x) / count, np.bincount(line, force) / area, area


def test_reference_numbers():
    assert pytest.approx(1.047464e-3, rel=1e-6) == HALF_WIDTH
    assert pytest.approx(121.5545e6, rel=1e-6) == PEAK


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
@pytest.mark.parametrize("method", sharp(AT_ONCE))
def test_pressure_and_width(comm, shared_tmp_path, method, model):
    check_pressure(comm, touching(comm, shared_tmp_path, method, 10, model), model)


@pytest.mark.parametrize("method", ["condensed", "multipliers", "augmented-lagrangian"])
@pytest.mark.parametrize("model", ["plane-strain", "3d"])
@pytest.mark.parametrize("forms", [("taylor-hood", ""), ("", "taylor-hood"), ("taylor-hood",) * 2])
def test_pressure_and_width_of_quadratic_cylinders(comm, shared_tmp_path, forms, method, model):
    check_pressure(comm, touching(comm, shared_tmp_path, method, 10, model, forms), model)


@pytest.mark.parametrize("method", ["condensed", "multipliers"])
def test_pressure_and_width_of_mixed_tetrahedra(comm, shared_tmp_path, method):
    made = touching(comm, shared_tmp_path, method, 10, "3d", ("mixed", "mixed"))
    check_pressure(comm, made, "3d")


def check_pressure(comm, made, model):
    """Compare load, peak, width and pressures with the exact ones, on ten elements."""
    depth = DEPTH * HALF_WIDTH / 10 if model == "3d" else 1.0
    total = comm.allreduce(made.contact_states()[0].force.sum(axis=0))
    assert total[1] == pytest.approx(0.5 * LOAD * depth, rel=1e-3)
    x, p, areas = profile(comm, made)
    # The node on the axis carries half an element; its neighbour makes up for what it misses.
    near = x < 1.5 * HALF_WIDTH / 10
    assert p[near] @ areas[near] / areas[near].sum() == pytest.approx(PEAK, rel=0.03)
    assert p.max() == pytest.approx(PEAK, rel=0.03)
    assert x[p > 0].max() == pytest.approx(HALF_WIDTH, rel=0.1)
    inside = x < 0.9 * HALF_WIDTH
    error = p[inside] - exact_pressure(x[inside])
    assert np.sqrt(np.mean(error**2)) < 0.03 * PEAK


def test_the_error_falls_with_the_mesh(comm, shared_tmp_path):
    errors = []
    for elements in (5, 10, 20):
        x, p, areas = profile(comm, touching(comm, shared_tmp_path, "condensed", elements))
        errors.append(math.sqrt(areas @ (p - exact_pressure(x)) ** 2))
    assert errors[0] > 1.6 * errors[1] > 1.6**2 * errors[2]
