"""Quadratic bodies in contact: one body cut in two, friction, and a thin wall on a stop.

A body that is cut and tied again moves as the whole body. Two blocks under a pressure p whose upper
one is drawn along slide at the traction μ p, and so does the shear stress in both: the lower one
leans by μ p H/G. A cantilever under its load q per length, whose end a stop holds, presses on it by
3/8 q L (Timoshenko, Strength of Materials, part I, 3rd ed., section 43), less what shear gives way:
the tip by q L⁴/(8 E I) + 6/5 q L²/(2 G h) without the stop, by R L³/(3 E I) + 6/5 R L/(G h) under
its force R; in plane strain E/(1 − ν²) stands for E.
"""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.contact import BY_NODES, Pairing
from castx.contact.choice import Contact
from castx.domain.mesh import CastingMesh
from castx.meshes.linear_mesh import LinearMesh
from castx.meshes.model import everything_else, fill_model, plane
from castx.meshes.structured import grid, swept
from tests.contact_methods import AT_ONCE, WITH_FRICTION
from tests.elastic_bodies import (
    body,
    drawn,
    elastic,
    everywhere,
    fixed,
    heat,
    motion,
    places,
    problem,
    pulled,
    pushed,
    sorted_by_place,
)
from tests.partitions import PARTITION, scattered

YOUNG, SIDE, FINE = 70e9, 0.02, 1e-9
BY_FACES = Pairing(kind="node-to-face", surfaces=("lower", "upper"))


def meshed(
    comm: MPI.Intracomm, folder: Path, mesh: LinearMesh, bodies: list[str], surfaces
) -> CastingMesh:
    """Return the mesh of bodies by the regions of cells."""
    model = "3d" if mesh.dimension == 3 else "plane-strain"
    return drawn(
        comm, model, bodies, folder / "mesh.msh", lambda: fill_model(mesh, bodies, surfaces)
    )


def block(cut: bool, space: bool) -> LinearMesh:
    """Return a block of 20 × 40 mm, whose upper half is another body if it is cut."""
    x, y = (np.array([*steps], dtype=np.float64) * SIDE / 3 for steps in (range(4), range(-3, 4)))
    made = grid(x, y, lambda middle: np.where(cut & (middle[:, 1] > 0), 1, 0))
    if not space:
        return made
    return swept(made, np.array([0.0, 0.01]), lambda under, z: under)


def pulled_block(
    comm, folder: Path, forms: dict[str, str], space: bool, rule: Pairing = BY_NODES
):  # fmt: skip
    """Return a block of one or two tied bodies in equilibrium, pulled aside, unevenly hot."""
    names = list(forms)
    surfaces = [plane("low", 1, -SIDE, FINE), plane("high", 1, SIDE, FINE), everything_else("side")]
    mesh = meshed(comm, folder, block(len(names) == 2, space), names, surfaces)
    pull = pulled("high", *((3e6, 2e6, 1e6) if space else (3e6, 2e6)))
    bodies = {
        name: body(
            elastic(YOUNG, 0.33, 2e-5), formulation=forms[name], loads=(pull,) * (name == names[-1])
        )
        for name in names
    }  # fmt: skip
    ties = [Contact("upper", "lower", "tied", pairing=rule)] * (len(names) - 1)
    made = problem(mesh, bodies, {"lower": [fixed("low", "all")]}, ties, tolerance=1e-11)
    heat(made, lambda x: 20.0 + 1e3 * x[:, 0] + 2e3 * x[:, 1])
    made.equilibrium.solve(0.0)
    return made


def on_the_cut(comm, made, name: str):
    """Return motions of nodes and mid-sides of a body on the cut, each in the order of places."""
    part, owned = made.bodies[name], made.bodies[name].owned_nodes
    d, middles = part.dimension, part.midsides
    points, moved = part.mesh.points, part.solution.x.array.reshape(-1, part.block_size)[:, :d]
    here = np.flatnonzero(np.abs(points[:owned, 1]) < FINE)
    found = [sorted_by_place(everywhere(comm, points[here]), everywhere(comm, moved[here]))[1]]
    own = middles.ends[: middles.owned_midsides]
    edges = np.flatnonzero(np.abs(points[own][:, :, 1]).max(axis=1) < FINE)
    centres, bubbles = points[own[edges]].mean(axis=1), middles.solution.x.array.reshape(-1, d)
    of_edges = everywhere(comm, centres), everywhere(comm, bubbles[edges])
    return [*found, sorted_by_place(*of_edges)[1]]


@pytest.mark.ranks
@pytest.mark.parametrize("space", [False, True])
def test_a_body_cut_in_two_moves_as_one(comm, shared_tmp_path, space, monkeypatch):
    """But for the pressure, which may jump at the cut: its top moves by 1 % more at most."""
    monkeypatch.setattr(PARTITION, scattered)
    forms = {"lower": "taylor-hood", "upper": "taylor-hood"}
    cut = pulled_block(comm, shared_tmp_path, forms, space)
    below, above = on_the_cut(comm, cut, "lower"), on_the_cut(comm, cut, "upper")
    for lower, upper in zip(below, above, strict=True):
        size = np.abs(lower).max()
        assert len(lower) > 2 and size > 1e-8
        np.testing.assert_allclose(upper, lower, atol=1e-10 * size)
    whole = pulled_block(comm, shared_tmp_path, {"lower": "taylor-hood"}, space)
    tops = []
    for made, name in ((cut, "upper"), (whole, "lower")):
        there = np.abs(places(made, name)[:, 1] - SIDE) < FINE
        d = made.bodies[name].dimension
        tops.append(everywhere(comm, motion(made, name)[there, :d]).mean(axis=0))
    assert np.abs(tops[0] - tops[1]).max() < 0.01 * np.abs(tops[1]).max()


@pytest.mark.ranks
@pytest.mark.parametrize("rule", [BY_NODES, BY_FACES])
@pytest.mark.parametrize("quadratic", ["lower", "upper"])
def test_edges_that_are_tied_to_a_linear_body_stay_straight(comm, shared_tmp_path, quadratic, rule):
    forms = {"lower": "displacement", "upper": "displacement"} | {quadratic: "taylor-hood"}
    made = pulled_block(comm, shared_tmp_path, forms, False, rule)
    assert np.abs(on_the_cut(comm, made, quadratic)[1]).max() < 1e-20
    assert (
        comm.allreduce(np.abs(made.bodies[quadratic].midsides.solution.x.array).max(), max) > 1e-8
    )


@pytest.mark.ranks
def test_edges_of_both_bodies_are_straight_where_their_meshes_do_not_match(comm, shared_tmp_path):
    forms = {"lower": "taylor-hood", "upper": "taylor-hood"}
    made = pulled_block(comm, shared_tmp_path, forms, True, BY_FACES)
    for name in forms:
        assert np.abs(on_the_cut(comm, made, name)[1]).max() < 1e-20
        most = np.abs(made.bodies[name].midsides.solution.x.array).max()
        assert comm.allreduce(most, max) > 1e-8


FRICTION, PRESSURE, DRAWN = 0.2, 10e6, 1e-4


@pytest.mark.ranks
@pytest.mark.parametrize("method", WITH_FRICTION)
@pytest.mark.parametrize("pair", [("taylor-hood", "taylor-hood"), ("taylor-hood", "displacement")])
@pytest.mark.parametrize("space", [True, False])
def test_a_uniform_shear_crosses_a_sliding_interface(comm, shared_tmp_path, space, pair, method):
    """Steel without lateral contraction; both blocks are sheared by forces on their sides too."""
    surfaces = [
        plane("low", 1, -SIDE, FINE), plane("high", 1, SIDE, FINE), plane("left", 0, 0.0, FINE),
        plane("right", 0, SIDE, FINE), everything_else("front"),
    ]  # fmt: skip
    names = ["base", "slider"]
    mesh = meshed(comm, shared_tmp_path, block(True, space), names, surfaces)
    shear = FRICTION * PRESSURE
    rest = (0.0,) * space
    sides = (pulled("right", 0.0, shear, *rest), pulled("left", 0.0, -shear, *rest))
    forms = dict(zip(reversed(names), pair, strict=True))
    bodies = {
        "base": body(elastic(YOUNG, 0.0), formulation=forms["base"], loads=sides),
        "slider": body(
            elastic(YOUNG, 0.0), formulation=forms["slider"],
            loads=(*sides, pushed("high", PRESSURE)),
        ),
    }  # fmt: skip
    held = {"base": [fixed("low", "all")], "slider": [fixed("high", "x", DRAWN)]}
    contact = Contact("slider", "base", method, friction=FRICTION)
    made = problem(mesh, bodies, held, [contact], tolerance=1e-10)
    made.equilibrium.solve(0.0)
    leaning = shear / (YOUNG / 2) * SIDE
    for name, level, expected in (("base", 0.0, leaning), ("slider", 0.0, DRAWN - leaning)):
        there = np.abs(places(made, name)[:, 1] - level) < FINE
        moved = everywhere(comm, motion(made, name)[there, 0])
        np.testing.assert_allclose(moved, expected, rtol=1e-7)
    force = everywhere(comm, made.contact_states()[0].force)
    areas = everywhere(comm, made.pairs[0].areas)
    np.testing.assert_allclose(force[:, 0] / areas, -shear, rtol=1e-7)
    np.testing.assert_allclose(force[:, 1] / areas, PRESSURE, rtol=1e-7)


LENGTH, HEIGHT, POISSON, LOAD = 0.04, 0.002, 0.33, 2e4


def wall_on_a_stop(comm, folder: Path, formulation: str, method: str, across: int = 1):
    """Return a wall of cells as long as it is high over the number across, on a rigid stop."""
    x = np.array([*range(across * round(LENGTH / HEIGHT) + 1)], dtype=np.float64)
    x *= HEIGHT / across
    y = np.concatenate((np.array([-HEIGHT]), np.linspace(0.0, HEIGHT, across + 1)))
    last = x[-2]

    def region(middle):
        below = np.where(middle[:, 0] > last, 1, -1)
        return np.where(middle[:, 1] > 0, 0, below)

    surfaces = [
        plane("wall", 0, 0.0, FINE), plane("top", 1, HEIGHT, FINE), plane("foot", 1, -HEIGHT, FINE),
        everything_else("side"),
    ]  # fmt: skip
    mesh = meshed(comm, folder, grid(x, y, region), ["casting", "stop"], surfaces)
    bodies = {
        "casting": body(
            elastic(YOUNG, POISSON), formulation=formulation, loads=(pushed("top", LOAD),)
        ),
        "stop": body(elastic(1e4 * YOUNG, POISSON), formulation="displacement"),
    }  # fmt: skip
    held = {"casting": [fixed("wall", "all")], "stop": [fixed("foot", "all")]}
    made = problem(mesh, bodies, held, [Contact("casting", "stop", method)], tolerance=1e-9)
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE[:2])
def test_a_wall_of_one_cell_across_leans_on_a_stop(comm, shared_tmp_path, method):
    made = wall_on_a_stop(comm, shared_tmp_path, "taylor-hood", method)
    points, moved = places(made, "casting"), motion(made, "casting")
    stiff = YOUNG / (1 - POISSON**2) * HEIGHT**3 / 12
    shear = YOUNG / (2 * (1 + POISSON)) * HEIGHT / 1.2
    force = everywhere(comm, made.contact_states()[0].force)[:, 1]
    place = everywhere(comm, made.pairs[0].points[:, 0])
    at = float(force @ place / force.sum())
    free = LOAD * at**2 * (6 * LENGTH**2 - 4 * LENGTH * at + at**2) / (24 * stiff)
    free += LOAD * (LENGTH * at - at**2 / 2) / shear
    expected = free / (at**3 / (3 * stiff) + at / shear)
    assert force.sum() == pytest.approx(expected, rel=0.01)
    middle = np.abs(points[:, 0] - LENGTH / 2) < FINE
    sag = everywhere(comm, moved[middle, 1]).mean()
    z, total = LENGTH / 2, force.sum()
    down = LOAD * z**2 * (6 * LENGTH**2 - 4 * LENGTH * z + z**2) / (24 * stiff)
    down += LOAD * (LENGTH * z - z**2 / 2) / shear
    up = total * (z**2 * (3 * at - z) / (6 * stiff) + z / shear)
    assert sag == pytest.approx(up - down, rel=0.03)
