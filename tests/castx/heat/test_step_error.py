"""Errors of temperatures by the steps, beside exact ones and runs in steps that are far smaller."""

from __future__ import annotations

from functools import cache

from mpi4py import MPI

import numpy as np
import pytest

from castx.domain.measures import nodal_volumes
from castx.domain.pairs.node_pairs import node_pairs
from castx.heat.body import HeatBody
from castx.heat.interface import HeatExchange
from castx.heat.problem import HeatProblem
from castx.input.variation import Variation
from castx.tables import Table
from tests.castx.heat.heat_cases import ALLOY, ALUMINIUM, PLAIN_STEEL, cylinder, material
from tests.heat_conditions import surface_heat
from tests.heat_resistance import LAYER, of_resistance

HOT, COLD, CLOSED = 700.0, 200.0, 2300.0
QUENCH = {"coefficient": Variation.constant(500.0), "ambient": Table.constant(20.0)}
CONDITIONS = {
    "insulated": (),
    "convection": (surface_heat("mould/outside", "convection", **QUENCH),),
    "temperature": (surface_heat("mould/outside", "temperature", value=Table.constant(90.0)),),
}


def heat_problem(mesh, metal, kind="law", surfaces=()) -> HeatProblem:
    pairs = node_pairs(mesh, "casting", "mould")
    bodies = [
        HeatBody("casting", material(metal), HOT),
        HeatBody("mould", material(PLAIN_STEEL), COLD),
    ]
    return HeatProblem(mesh, bodies, [HeatExchange("casting/mould", pairs, kind, LAYER)], surfaces)


def states_of(mesh):
    count = len(node_pairs(mesh, "casting", "mould").areas)
    state = of_resistance(np.full(count, 1.0 / CLOSED))
    return [(state, state)]


def owned(heat) -> np.ndarray:
    """Return the temperatures of the owned nodes on this rank."""
    functions = heat.temperature.values()
    return np.concatenate(
        [f.x.array[: f.function_space.dofmap.index_map.size_local] for f in functions]
    )


def advance(heat, mesh, steps, substeps=1, time=0.0):
    """Take steps; return the temperatures and errors after each of them."""
    states, found = states_of(mesh), []
    for step in steps:
        heat.advance(time, step, states, substeps)
        error = heat.step_error(states)
        heat.commit()
        time += step
        found.append((owned(heat), error))
    return found


def run(mesh, metal, steps, substeps=1, kind="law", surfaces=()):
    heat = heat_problem(mesh, metal, kind, surfaces)
    found = advance(heat, mesh, steps, substeps)
    heat.destroy()
    return found


@cache
def mesh_of():
    return cylinder(MPI.COMM_SELF, size=0.01)


def ratios(metal, substeps=1, kind="law", surfaces=(), fine=4):
    """Return estimated over true errors after each step, and over the largest of all steps."""
    mesh, step, count = mesh_of(), 0.5, 16
    taken = run(mesh, metal, [step] * count, substeps, kind, surfaces)
    exact = run(mesh, metal, [step / fine] * (count * fine), substeps, kind, surfaces)
    pairs = zip(taken, exact[fine - 1 :: fine], strict=True)
    # What the fine steps are off by themselves is a quarter.
    true = np.array([np.abs(a - b).max() for (a, _), (b, _) in pairs]) * fine / (fine - 1)
    made = np.array([error.made for _, error in taken])
    return made / true, made.max() / true.max()


@pytest.mark.serial
@pytest.mark.parametrize(
    "metal, substeps, kind, condition, low",
    [
        (ALLOY, 1, "law", "insulated", 0.95),
        (ALLOY, 3, "law", "convection", 0.9),
        (PLAIN_STEEL, 1, "law", "temperature", 0.9),
        (ALUMINIUM, 1, "law", "insulated", 0.65),  # as the front comes to another node
    ],
)
def test_the_error_made_is_the_true_one(metal, substeps, kind, condition, low):
    each, largest = ratios(metal, substeps, kind, CONDITIONS[condition])
    assert each.min() > low and each.max() < (1.15 if low > 0.8 else 1.35)
    assert largest == pytest.approx(1.0, abs=0.1 if low > 0.8 else 0.3)


def freezing(substeps, kind, end):
    """Return estimated and true errors of aluminium after each step of half a second."""
    mesh, step, fine, count = mesh_of(), 0.5, 8, round(2 * end)
    taken = run(mesh, ALUMINIUM, [step] * count, substeps, kind)
    exact = run(mesh, ALUMINIUM, [step / fine] * (count * fine), substeps, kind)
    true = [
        np.abs(at - finer).max() * fine / (fine - 1)
        for (at, _), (finer, _) in zip(taken, exact[fine - 1 :: fine], strict=True)
    ]
    return np.array([error.made for _, error in taken]), np.array(true)


@pytest.mark.serial
@pytest.mark.parametrize(
    "substeps, kind, spans",
    [(1, "law", [(0.0, 8.0), (10.0, 22.0), (22.0, 30.0)]), (2, "perfect", [(0.0, 8.0), (8.0, 20)])],
)
def test_nodes_at_a_melting_point_tell_in_advance_what_they_will_be_off(substeps, kind, spans):
    """The largest estimate of a span is the largest error in it, which comes as nodes freeze."""
    made, true = freezing(substeps, kind, spans[-1][1])
    for start, end in spans:
        part = slice(round(start / 0.5), round(end / 0.5))
        assert made[part].max() == pytest.approx(true[part].max(), rel=0.4)


@pytest.mark.serial
def test_an_error_is_told_before_it_is_seen():
    """The next seven nodes stay at the melting point until 19 s."""
    made, true = freezing(1, "law", 20.0)
    late = slice(30, 38)
    assert true[late].max() < 0.3 * true[38]
    assert made[late] == pytest.approx(true[38], rel=0.1)


@pytest.mark.serial
def test_the_error_of_uniform_steps_is_that_of_the_present_ones():
    """Equal steps have made it; after shorter ones less was made."""
    mesh = mesh_of()
    equal = [error for _, error in run(mesh, ALLOY, [0.5] * 8)]
    assert [error.made for error in equal] == pytest.approx([error.uniform for error in equal])
    longer = run(mesh, ALLOY, [0.25] * 8 + [1.0])[-1][1]
    assert longer.uniform > 1.5 * longer.made
    halves = run(mesh, ALLOY, [0.25] * 16)[-1][1]
    assert halves.uniform == pytest.approx(0.5 * equal[-1].uniform, rel=0.1)


@pytest.mark.serial
def test_a_metal_at_its_melting_point_has_the_error_that_its_heat_will_make():
    mesh = mesh_of()
    heat = heat_problem(mesh, ALUMINIUM | {"heat_capacity": 1000.0})
    (temperature, error), *_ = advance(heat, mesh, [1.0] * 6)[5:]
    casting = heat.saved()["step_error/casting"].values[:, 1]
    volumes = nodal_volumes(mesh.bodies["casting"], mesh.model)
    surplus = abs(volumes @ casting) / volumes.sum() / (2700.0 * 1000.0)
    assert (temperature[: len(casting)] == 660.0).any()
    assert error.made >= surplus * (1 - 1e-12) > 0.0
    heat.destroy()


@pytest.mark.serial
def test_a_step_that_is_taken_back_leaves_no_error():
    mesh, states = mesh_of(), states_of(mesh_of())
    heat, other = heat_problem(mesh, ALLOY), heat_problem(mesh, ALLOY)
    for problem in (heat, other):
        advance(problem, mesh, [0.5, 0.5])
    heat.advance(1.0, 3.0, states)
    heat.step_error(states)
    heat.rewind()
    (_, found), (_, expected) = (advance(p, mesh, [0.7], time=1.0)[0] for p in (heat, other))
    assert (found.made, found.uniform) == pytest.approx((expected.made, expected.uniform), rel=1e-9)
    heat.destroy()
    other.destroy()


@pytest.mark.serial
def test_an_estimate_changes_nothing_of_the_step():
    mesh, states = mesh_of(), states_of(mesh_of())
    heat = heat_problem(mesh, ALUMINIUM)
    heat.advance(0.0, 2.0, states, 2)
    before, flows = owned(heat), heat.coefficients([state for state, _ in states])
    heat.step_error(states)
    np.testing.assert_array_equal(owned(heat), before)
    np.testing.assert_array_equal(heat.coefficients([state for state, _ in states]), flows)
    heat.destroy()


@pytest.mark.serial
def test_errors_go_on_from_a_saved_state():
    mesh = mesh_of()
    heat = heat_problem(mesh, ALLOY)
    advance(heat, mesh, [0.5] * 4)
    saved = {name: item.values for name, item in heat.saved().items()}
    other = heat_problem(mesh, ALLOY)
    other.restore(saved)
    (_, found), (_, expected) = (advance(p, mesh, [0.5], time=2.0)[0] for p in (other, heat))
    assert (found.made, found.uniform) == pytest.approx((expected.made, expected.uniform), rel=1e-9)
    heat.destroy()
    other.destroy()


@pytest.mark.ranks
@pytest.mark.parametrize("metal", [ALLOY, ALUMINIUM])
@pytest.mark.parametrize("kind", ["law", "perfect"])
def test_ranks_find_the_same_errors(comm, kind, metal):
    surfaces = CONDITIONS["temperature"]
    found = run(cylinder(comm, size=0.01), metal, [0.5] * 4, 2, kind, surfaces)
    alone = run(cylinder(MPI.COMM_SELF, size=0.01), metal, [0.5] * 4, 2, kind, surfaces)
    for (_, error), (_, expected) in zip(found, alone, strict=True):
        assert error.made == pytest.approx(expected.made, rel=1e-6)
        assert error.uniform == pytest.approx(expected.uniform, rel=1e-6)
        assert error.substeps == 2


@pytest.mark.serial
def test_errors_of_latent_heat_inside_cells_do_not_grow_by_themselves():
    """Steps too short to add anything leave them as they are, while an alloy of 5 K freezes."""
    mesh = mesh_of()
    steep = ALLOY | {"solidus": 600.0, "liquidus": 605.0}
    bodies = [
        HeatBody("casting", material(steep), HOT, inside=True),
        HeatBody("mould", material(PLAIN_STEEL), COLD),
    ]
    pairs = node_pairs(mesh, "casting", "mould")
    exchanges = [HeatExchange("casting/mould", pairs, "law", LAYER)]
    heat = HeatProblem(mesh, bodies, exchanges, ())
    before = advance(heat, mesh, [0.5] * 16)[-1][1].made
    after = [error.made for _, error in advance(heat, mesh, [1e-6] * 30, time=8.0)]
    heat.destroy()
    assert before > 0.5
    np.testing.assert_allclose(after, before, rtol=0.02)
