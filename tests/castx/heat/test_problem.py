"""The heat problem: steps that are tried, taken back and committed, exact answers, ranks."""

from __future__ import annotations

from functools import partial

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.errors import CaseError, ConvergenceError, MeshError
from castx.heat.body import HeatBody
from castx.heat.boundaries import SurfaceHeat
from castx.heat.interface import HeatExchange
from castx.heat.problem import HeatProblem
from castx.input.variation import Variation
from castx.tables import Table
from castx.transfer.conditions.registry import heat_conditions
from castx.transfer.pair_state import PairState
from tests.castx.heat.heat_cases import (
    ALUMINIUM,
    STEEL,
    cylinder,
    largest,
    material,
    temperatures_at,
)
from tests.heat_conditions import surface_heat
from tests.heat_resistance import LAYER, of_resistance
from tests.partitions import PARTITION, along_x

SURROUNDINGS = {"coefficient": Variation.constant(50.0), "ambient": Table.constant(25.0)}


def outside(kind="convection", **numbers) -> SurfaceHeat:
    given = numbers or (SURROUNDINGS if kind == "convection" else {})
    return surface_heat("mould/outside", kind, **given)


def problem(mesh, kind="law", surfaces=None, sources=None, **settings) -> HeatProblem:
    exchange = HeatExchange("casting/mould", node_pairs(mesh, "casting", "mould"), kind, LAYER)
    source = Table.constant(sources) if sources else None
    bodies = [
        HeatBody("casting", material(ALUMINIUM), 670.0, source),
        HeatBody("mould", material(STEEL), 200.0),
    ]
    surfaces = [outside()] if surfaces is None else surfaces
    return HeatProblem(mesh, bodies, [exchange], surfaces, **settings)


def resistances(mesh, coefficient=2300.0):
    count = len(node_pairs(mesh, "casting", "mould").areas)
    return [given(np.full(count, 1 / coefficient))]


def given(start, end=None) -> tuple[PairState, PairState]:
    """Return the states of pairs at start and end of a step, of given resistances."""
    return of_resistance(start), of_resistance(start if end is None else end)


def run(heat, mesh, steps, substeps=1, coefficient=2300.0) -> float:
    time = 0.0
    for step in steps:
        heat.advance(time, step, resistances(mesh, coefficient), substeps)
        heat.commit()
        time += step
    return time


def state(heat, mesh) -> np.ndarray:
    """Return the owned temperatures of both bodies on this rank."""
    owned = {name: body.nodes.dofmap.index_map.size_local for name, body in mesh.bodies.items()}
    return np.concatenate([heat.temperature[name].x.array[: owned[name]] for name in owned])


@pytest.mark.parametrize("kind", ["law", "perfect"])
@pytest.mark.parametrize("model", ["axisymmetric", "3d"])
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_heat_is_neither_lost_nor_made(comm, kind, model, cells):
    mesh = cylinder(comm, model=model, size=1e-2, cells=cells)
    heat = problem(mesh, kind, sources=2e6)
    before = heat.totals()
    time = run(heat, mesh, [0.1, 1.0, 10.0], substeps=2)
    totals = heat.totals()
    assert totals["energy_error"] < 1e-9
    turn = 1.0 if model == "axisymmetric" else 0.25
    volume = turn * np.pi * 0.03**2 * 0.06
    assert totals["casting.source"] == pytest.approx(2e6 * volume * time, rel=0.05)
    gained = totals["mould.enthalpy"] + totals["casting.enthalpy"]
    gained -= before["mould.enthalpy"] + before["casting.enthalpy"]
    received = totals["casting.source"] + totals["mould/outside.heat"]
    assert gained == pytest.approx(received, rel=1e-6)
    assert totals["casting.heat_in"] == pytest.approx(
        totals["casting.source"] - totals["casting/mould.heat"], rel=1e-12
    )
    assert totals["casting/mould.heat"] > 0.0 > totals["mould/outside.heat"]


def test_trial_state_can_be_taken_back_and_found_again(comm):
    mesh = cylinder(comm)
    heat = problem(mesh)
    run(heat, mesh, [0.5])
    totals, old = heat.totals(), state(heat, mesh).copy()
    heat.advance(0.5, 3.0, resistances(mesh))
    tried = state(heat, mesh).copy()
    assert heat.totals() == totals
    assert largest(comm, tried - old) > 1.0
    heat.rewind()
    assert (state(heat, mesh) == old).all()
    heat.advance(0.5, 1.0, resistances(mesh))
    assert heat.advance(0.5, 3.0, resistances(mesh)).iterations > 0
    assert largest(comm, state(heat, mesh) - tried) < 1e-6
    assert heat.advance(0.5, 3.0, resistances(mesh)).iterations == 0
    heat.commit()
    assert heat.totals() != totals


def test_substeps_are_steps(comm):
    mesh = cylinder(comm)
    one, other = (problem(mesh, tolerance=1e-12) for _ in range(2))
    run(one, mesh, [4.0], substeps=4)
    run(other, mesh, [1.0] * 4)
    assert largest(comm, state(one, mesh) - state(other, mesh)) < 1e-9


def test_states_between_are_those_at_the_ends_of_the_substeps(comm):
    mesh = cylinder(comm)
    one, other = (problem(mesh, tolerance=1e-12) for _ in range(2))
    one.advance(0.0, 4.0, resistances(mesh), 4)
    for name in mesh.bodies:
        assert len(one.between(name)) == 3
    for number in range(3):
        run(other, mesh, [1.0])
        for name in mesh.bodies:
            passed = one.between(name)[number]
            of_nodes = other.temperature[name].x.array, other.solid_fraction[name].x.array
            assert largest(comm, passed.temperature - of_nodes[0]) < 1e-9
            assert largest(comm, passed.solid_fraction - of_nodes[1]) < 1e-9


def test_substeps_go_on_as_the_last_ones_did(comm):
    """What two sub-steps have changed is where the next one begins, which saves iterations."""
    mesh = cylinder(comm)
    one, other = problem(mesh), problem(mesh)
    together = one.advance(0.0, 8.0, resistances(mesh), substeps=8).iterations
    alone = 0
    for k in range(8):
        alone += other.advance(float(k), 1.0, resistances(mesh)).iterations
        other.commit()
    assert together < alone


def test_a_repeated_step_goes_on_as_its_last_substeps_have_changed(comm):
    """Another resistance lets sub-steps change alike; from the last result alone it takes 24."""
    mesh = cylinder(comm, size=4e-3)
    passes = [2000.0, 1000.0], [1000.0]
    found = []
    for coefficients in passes:
        heat = problem(mesh, tolerance=1e-6)
        run(heat, mesh, [2.0])
        for coefficient in coefficients:
            report = heat.advance(2.0, 5.0, resistances(mesh, coefficient), substeps=10)
        found.append((report.iterations, state(heat, mesh)))
    (again, repeated), (_, alone) = found
    assert again <= 19
    assert largest(comm, repeated - alone) < 1e-3


def test_substeps_take_the_resistances_of_their_middle(comm):
    """Resistances run straight from 1e-4 to 3e-4 over two sub-steps."""
    mesh = cylinder(comm)
    one, other = (problem(mesh, tolerance=1e-12) for _ in range(2))
    count = len(node_pairs(mesh, "casting", "mould").areas)
    start, quarter, rest, end = (np.full(count, 1e-4 * value) for value in (1, 1.5, 2.5, 3))
    one.advance(0.0, 2.0, [given(start, end)], substeps=2)
    other.advance(0.0, 1.0, [given(start, quarter)])
    other.commit()
    other.advance(1.0, 1.0, [given(quarter, rest)])
    assert largest(comm, state(one, mesh) - state(other, mesh)) < 1e-9


@pytest.mark.parametrize("kind", ["law", "none"])
def test_nothing_passes_an_infinite_resistance_or_no_exchange(comm, kind):
    mesh = cylinder(comm)
    heat = problem(mesh, kind)
    infinite = np.full(len(node_pairs(mesh, "casting", "mould").areas), np.inf)
    heat.advance(0.0, 5.0, [given(infinite)], substeps=2)
    heat.commit()
    assert heat.totals()["casting/mould.heat"] == 0.0
    assert heat.totals()["casting.heat_in"] == 0.0


def test_perfect_contact_is_the_limit_of_small_resistance(comm):
    mesh = cylinder(comm)
    perfect, close = problem(mesh, "perfect"), problem(mesh)
    run(perfect, mesh, [0.5] * 4)
    run(close, mesh, [0.5] * 4, coefficient=1e9)
    assert largest(comm, state(perfect, mesh) - state(close, mesh)) < 0.05
    heats = [heat.totals()["casting/mould.heat"] for heat in (perfect, close)]
    assert heats[0] == pytest.approx(heats[1], rel=1e-3)


def test_perfect_contact_gives_facing_nodes_one_temperature(comm):
    mesh = cylinder(comm)
    heat = problem(mesh, "perfect")
    run(heat, mesh, [0.01, 0.1, 1.0])
    pairs = node_pairs(mesh, "casting", "mould")
    facing = temperatures_at(comm, mesh.bodies["mould"], heat.temperature["mould"], pairs.points)
    own = heat.temperature["casting"].x.array[pairs.secondary_local]
    assert comm.allreduce(len(own)) > 5
    assert largest(comm, own - facing) < 1e-9


def test_prescribed_temperature_of_joined_nodes_and_where_two_meet(comm):
    mesh = cylinder(comm)
    values = {"top": 150.0, "outside": 100.0}
    surfaces = [
        surface_heat(f"mould/{name}", "temperature", value=Table.constant(value))
        for name, value in values.items()
    ]
    heat = problem(mesh, "perfect", surfaces)
    run(heat, mesh, [0.1, 1.0])
    totals = heat.totals()
    assert totals["energy_error"] < 1e-9
    mould = mesh.bodies["mould"]
    top = heat.temperature["mould"].x.array[mould.surface_nodes("top")]
    np.testing.assert_array_max_ulp(top, np.full_like(top, 150.0))  # factors may round it
    received = totals["mould/top.heat"] + totals["mould/outside.heat"]
    received += totals["casting/mould.heat"]
    assert totals["mould.heat_in"] == pytest.approx(received, rel=1e-12)


def test_given_flux_and_table_over_time(comm):
    mesh = cylinder(comm)
    flux = Table.from_points([[0.0, 0.0], [10.0, 1e4]])
    heat = problem(mesh, "none", [outside("flux", value=flux), outside("insulated")])
    run(heat, mesh, [5.0, 5.0])
    area = 2 * np.pi * 0.05 * 0.06
    totals = heat.totals()
    assert totals["mould/outside.heat"] == pytest.approx(area * 0.5 * 10.0 * 1e4, rel=1e-9)
    assert totals["mould.heat_in"] == pytest.approx(totals["mould/outside.heat"], rel=1e-12)
    assert totals["energy_error"] < 1e-9


def test_conditions_on_one_surface_add_up(comm):
    mesh = cylinder(comm)
    both = problem(mesh, "none", [outside(), outside()])
    double = outside(coefficient=Variation.constant(100.0), ambient=Table.constant(25.0))
    one = problem(mesh, "none", [double])
    for heat in (both, one):
        run(heat, mesh, [10.0])
    assert largest(comm, state(both, mesh) - state(one, mesh)) < 1e-9


def test_equilibrium_stays_without_iterations(comm):
    mesh = cylinder(comm)
    heat = HeatProblem(
        mesh,
        [HeatBody("casting", material(STEEL), 137.3), HeatBody("mould", material(STEEL), 137.3)],
        [HeatExchange("casting/mould", node_pairs(mesh, "casting", "mould"), law=LAYER)],
        [outside(coefficient=Variation.constant(1e4), ambient=Table.constant(137.3))],
    )
    report = heat.advance(0.0, 1e-3, resistances(mesh))
    assert report.iterations == 0
    heat.advance(0.0, 1e9, resistances(mesh))
    heat.commit()
    assert largest(comm, state(heat, mesh) - 137.3) < 1e-9


@pytest.mark.ranks
def test_long_run_ends_at_the_temperature_of_the_surroundings(comm):
    mesh = cylinder(comm)
    heat = problem(mesh)
    run(heat, mesh, [1.0, 1e2, 1e4, 1e6, 1e8])
    assert largest(comm, state(heat, mesh) - 25.0) < 1e-3
    assert heat.totals()["energy_error"] < 1e-6


def test_largest_temperature_change_leaves_out_prescribed_nodes(comm):
    mesh = cylinder(comm)
    chilled = [outside("temperature", value=Table.constant(20.0))]
    small = problem(mesh, "none", chilled).advance(0.0, 1e-4, [None])
    assert 0.0 < small.largest_temperature_change < 1.0
    heat = problem(mesh, "none", chilled)
    old = state(heat, mesh).copy()
    report = heat.advance(0.0, 5.0, [None])
    assert report.largest_temperature_change < largest(comm, state(heat, mesh) - old)


@pytest.mark.ranks
def test_largest_temperature_change_is_that_of_all_ranks(comm, monkeypatch):
    """The outside cools most, which belongs to the last rank."""
    monkeypatch.setattr(PARTITION, along_x)
    mesh = cylinder(comm, size=1e-2)
    heat = problem(mesh, "none")
    old = state(heat, mesh).copy()
    report = heat.advance(0.0, 5.0, [None])
    expected = largest(comm, state(heat, mesh) - old)
    assert comm.allgather(report.largest_temperature_change) == [expected] * comm.size


@pytest.mark.parametrize("linear", ["direct", "iterative"])
def test_linear_solvers_agree(comm, linear):
    mesh = cylinder(comm)
    heat, reference = problem(mesh, linear=linear), problem(mesh)
    run(heat, mesh, [1.0, 10.0, 100.0])
    run(reference, mesh, [1.0, 10.0, 100.0])
    assert heat._solver.snes.ksp.getType() == {"direct": "preonly", "iterative": "gmres"}[linear]
    assert largest(comm, state(heat, mesh) - state(reference, mesh)) < 1e-5
    assert heat.totals()["energy_error"] < 1e-9


@pytest.mark.ranks
def test_petsc_options_override_the_defaults(comm):
    mesh = cylinder(comm)
    heat = problem(mesh, options={"ksp_type": "bcgs", "pc_type": "bjacobi"})
    run(heat, mesh, [1.0])
    assert heat._solver.snes.ksp.getType() == "bcgs"


@pytest.mark.parametrize("kind", ["law", "perfect"])
@pytest.mark.parametrize("solidus", [660, 659.99, 600])
def test_large_steps_need_few_iterations(comm, kind, solidus):
    mesh = cylinder(comm, size=3e-3)
    exchange = HeatExchange("casting/mould", node_pairs(mesh, "casting", "mould"), kind, LAYER)
    bodies = [
        HeatBody("casting", material(ALUMINIUM | {"solidus": solidus}), 670.0),
        HeatBody("mould", material(STEEL), 200.0),
    ]
    heat = HeatProblem(mesh, bodies, [exchange], [outside()])
    for time in (0.0, 300.0):
        assert heat.advance(time, 300.0, resistances(mesh)).iterations <= 20
        heat.commit()
    assert heat.totals()["energy_error"] < 1e-9


def scaled(properties, key, factor):
    """Return properties with all numbers of one of them multiplied; temperatures stay."""

    def times(value):
        if isinstance(value, dict):
            return {phase: times(part) for phase, part in value.items()}
        if isinstance(value, list):
            return [[temperature, factor * number] for temperature, number in value]
        return factor * value

    return {name: times(value) if name == key else value for name, value in properties.items()}


def test_other_units_take_the_same_iterations(comm):
    """Lengths in mm, heat in J: k in W/mm/K, ρ in kg/mm³, h in W/mm²/K."""
    meshes = {1.0: cylinder(comm, size=4e-3), 1e3: cylinder(comm, size=4e-3, length=1e3)}
    runs = {}
    for length, mesh in meshes.items():
        metal, steel = (
            scaled(scaled(given, "density", length**-3), "conductivity", 1 / length)
            for given in (ALUMINIUM, STEEL)
        )
        heat = HeatProblem(
            mesh,
            [
                HeatBody("casting", material(metal), 670.0),
                HeatBody("mould", material(steel), 200.0),
            ],
            [HeatExchange("casting/mould", node_pairs(mesh, "casting", "mould"), law=LAYER)],
            [outside(coefficient=Variation.constant(50 / length**2), ambient=Table.constant(25.0))],
        )
        passed = resistances(mesh, 2300.0 / length**2)
        counts = []
        for k in range(6):
            counts.append(heat.advance(5.0 * k, 5.0, passed).iterations)
            heat.commit()
        runs[length] = (counts, heat.totals(), state(heat, mesh))
    assert runs[1.0][0] == runs[1e3][0]
    assert runs[1e3][1]["mould.heat_in"] == pytest.approx(runs[1.0][1]["mould.heat_in"], rel=1e-9)
    assert largest(comm, runs[1.0][2] - runs[1e3][2]) < 1e-7


@pytest.mark.ranks
@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("kind", ["law", "perfect"])
def test_results_do_not_depend_on_the_number_of_ranks(comm, kind, cells):
    ends = []
    for ranks in (comm, MPI.COMM_SELF):
        mesh = cylinder(ranks, cells=cells)
        heat = problem(mesh, kind, linear="direct")
        run(heat, mesh, [0.5, 1.0, 2.0, 4.0])
        warmest = max(ranks.allgather(heat.temperature["mould"].x.array.max(initial=-np.inf)))
        ends.append(heat.totals() | {"warmest": warmest})
    together, alone = ends
    for name, value in alone.items():
        if name != "energy_error":
            assert together[name] == pytest.approx(value, rel=1e-8, abs=1e-12), name


@pytest.mark.parametrize("model, size", [("axisymmetric", 3e-3), ("3d", 5e-3)])
def test_quadrilaterals_and_simplices_agree(comm, model, size):
    ends = []
    for cells in ("simplices", "quadrilaterals"):
        mesh = cylinder(comm, model=model, size=size, cells=cells)
        heat = problem(mesh)
        run(heat, mesh, [0.5] * 10)
        volume = np.pi * 0.03**2 * 0.06 / (4 if model == "3d" else 1)
        hottest = max(comm.allgather(heat.temperature["mould"].x.array.max(initial=-np.inf)))
        heats = [heat.totals()[name] for name in ("casting/mould.heat", "casting.enthalpy")]
        ends.append((hottest, np.array(heats) / volume))
    assert ends[0][0] == pytest.approx(ends[1][0], abs=0.01 * (670.0 - 200.0))
    assert ends[0][1] == pytest.approx(ends[1][1], rel=0.01)


def test_linear_profiles_are_exact_on_skewed_hexahedra(comm):
    """A patch test of the conduction: T = 20 + 80 x between walls, insulated elsewhere."""
    sizes = {"length": 1.0, "width": 0.5, "depth": 0.4, "size": 0.12, "cells": "quadrilaterals"}
    description = {"model": "3d", "generator": "slab", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["casting"], comm)
    x = mesh.bodies["casting"].mesh.geometry.x
    bump = np.sin(np.pi * x[:, 0]) * np.sin(2 * np.pi * x[:, 1]) * np.sin(5 * np.pi * x[:, 2])
    x += 0.03 * bump[:, None] * [1.0, -0.6, 0.8]
    walls = [
        surface_heat(f"casting/{name}", "temperature", value=Table.constant(value))
        for name, value in (("wall", 20.0), ("far", 100.0))
    ]
    steel = material(STEEL | {"conductivity": 30.0})
    heat = HeatProblem(mesh, [HeatBody("casting", steel, 20.0)], (), walls)
    for k in range(3):
        heat.advance(k * 1e9, 1e9)
        heat.commit()
    points = mesh.bodies["casting"].nodes.tabulate_dof_coordinates()
    assert comm.allreduce(np.abs(bump).max(initial=0.0), MPI.MAX) > 0.5
    assert largest(comm, heat.temperature["casting"].x.array - 20.0 - 80.0 * points[:, 0]) < 1e-6


def test_failure_names_body_and_place(comm):
    mesh = cylinder(comm)
    heat = problem(mesh, options={"snes_max_it": 1})
    place = r"heat problem .* after 1 .* W in body '(casting|mould)' at \(.*\) m"
    with pytest.raises(ConvergenceError, match=place):
        heat.advance(0.0, 50.0, resistances(mesh))
    heat.rewind()
    assert largest(comm, state(heat, mesh)) == pytest.approx(670.0)


def test_bad_descriptions_are_refused(comm):
    mesh = cylinder(comm)
    casting = HeatBody("casting", material(ALUMINIUM), 670.0)
    with pytest.raises(CaseError, match="each of the bodies casting, mould once, got casting"):
        HeatProblem(mesh, [casting])
    with pytest.raises(CaseError, match=f"type: unknown; allowed: {', '.join(heat_conditions())}"):
        surface_heat("casting/wall", "chill")
    with pytest.raises(CaseError, match="value: missing; heat of type 'flux' needs it"):
        surface_heat("casting/wall", "flux")
    refused = partial(problem, mesh)
    with pytest.raises(MeshError, match="'mould' has no surface 'inside'"):
        refused(surfaces=[surface_heat("mould/inside", "insulated")])
    with pytest.raises(CaseError, match="core/base: no body 'core'; there are casting, mould"):
        refused(surfaces=[surface_heat("core/base", "insulated")])
