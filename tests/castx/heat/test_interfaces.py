"""Interfaces inside the heat problem: balance, mechanisms, parts, solid fraction of a body."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.domain.pairs.node_pairs import node_pairs
from castx.heat.interfaces import couple_step
from castx.transfer.conductance import ConstantConductance
from castx.transfer.patched import PatchedLaw
from castx.transfer.radiation import STEFAN_BOLTZMANN
from tests.castx.heat.heat_cases import (
    FALLING,
    LAWS,
    SERIES,
    SOLID,
    advanced,
    balance_under_law,
    cylinder,
    open_pairs,
    problem_under_law,
    temperatures_at,
)


@pytest.mark.parametrize("name", LAWS)
def test_heat_is_booked_by_mechanism_and_never_lost(comm, name):
    """Lost by one side, gained by the other to 1e-10; parts and powers add up."""
    mesh = cylinder(comm)
    heat = problem_under_law(mesh, *LAWS[name])
    before = heat.totals()
    steps = [0.5, 2.0, 5.0]
    energy = dict.fromkeys(before, 0.0)
    time = 0.0
    for step in steps:
        heat.advance(time, step, [open_pairs(mesh)], 2)
        heat.commit()
        time += step
        energy = {key: energy[key] + step * value for key, value in heat.totals().items()}
    totals = heat.totals()
    interface, outside = "casting/mould.heat", "mould/outside.heat"
    parts = {way: totals[f"{interface}.{way}"] for way in ("contact", "gas", "radiation")}
    assert totals[interface] == pytest.approx(sum(parts.values()), rel=1e-12)
    has = {way for way, value in parts.items() if value > 0.0}
    assert has == {
        "series": {"contact", "gas"}, "radiation": {"radiation"},
        "both": {"contact", "gas", "radiation"},
        "solid-fraction": {"contact", "gas", "radiation"},
    }[name]  # fmt: skip
    ways = [totals[f"{outside}.{way}"] for way in ("convection", "radiation")]
    assert max(ways) < 0.0
    assert totals[outside] == pytest.approx(sum(ways), rel=1e-12)
    assert "casting/top.heat.convection" not in totals  # the only one there
    for key in totals:
        if "heat" in key:
            power = key.replace(".heat_in", ".power").replace(".heat", ".power")
            assert energy[power] == pytest.approx(totals[key], rel=1e-9, abs=1e-9), key
    casting = totals["casting.source"] + totals["casting/top.heat"] - totals[interface]
    assert totals["casting.enthalpy"] - before["casting.enthalpy"] == pytest.approx(
        casting, rel=1e-7
    )
    assert totals["mould.heat_in"] == pytest.approx(totals[interface] + totals[outside], rel=1e-10)
    assert totals["energy_error"] < 1e-9


def test_steady_flux_through_gap_and_radiation_is_that_of_the_formula(comm):
    """The sum of h(T) (T₁ − T₂) + φσ(T₁⁴ − T₂⁴) over the pairs, against the ledger's power."""
    mesh = cylinder(comm)
    law = {"law": "limited", "closed": FALLING, "gas_conductivity": 0.04}
    heat = problem_under_law(mesh, law, 0.4)
    pairs = open_pairs(mesh, highest=4e-4)
    advanced(heat, mesh, [2.0, 2.0], pairs)
    facing = node_pairs(mesh, "casting", "mould")
    hot = heat.temperature["casting"].x.array[facing.secondary_local]
    cold = temperatures_at(comm, mesh.bodies["mould"], heat.temperature["mould"], facing.points)
    gap = pairs[1].gap
    closed = np.interp(hot, [0, 400, 800], [900, 1500, 600])
    h = np.minimum(closed, 0.04 / np.maximum(gap, 1e-12))
    radiated = 0.4 * STEFAN_BOLTZMANN * ((hot + 273.15) ** 4 - (cold + 273.15) ** 4)
    for way, flux in (("gas", h * (hot - cold) * (gap > 0)), ("radiation", radiated)):
        expected = comm.allreduce(float(facing.areas @ flux))
        assert heat.totals()[f"casting/mould.power.{way}"] == pytest.approx(expected, rel=1e-9)
    assert heat.coefficients([pairs[1]])[0] == pytest.approx(h)


def test_a_factor_multiplies_the_resistance_at_the_end_of_a_step(comm):
    mesh = cylinder(comm)
    end = open_pairs(mesh)[1]
    both = [problem_under_law(mesh, ConstantConductance(h), surfaces=()) for h in (800.0, 200.0)]
    quarter = [np.full(len(end.gap), 0.25)]
    for heat, factors in zip(both, (None, quarter), strict=True):
        heat.advance(0.0, 3.0, [(end, end)], factors=factors)
        heat.commit()
    one, other = (heat.totals()["casting/mould.heat"] for heat in both)
    assert one == pytest.approx(other, rel=1e-9)


@pytest.mark.serial
def test_the_sum_of_amounts_is_that_of_the_heat_of_the_pairs(comm):
    mesh = cylinder(comm)
    balance = balance_under_law(mesh, SERIES)
    balance.exchanges.set_states([open_pairs(mesh)], 0.7)
    x = balance.layout.create_vector()
    x.array[:] = balance.begin(*2 * [balance.unknowns.enthalpies()], 3.0, 1.0)
    balance.evaluate(x)
    amounts = [np.abs(e.heat().sum(axis=0)).sum() for e in balance.exchanges.under_law]
    assert balance.exchanges.add_heat(x) == pytest.approx(sum(amounts), rel=1e-12)


def test_coefficients_at_the_present_temperatures(comm):
    mesh = cylinder(comm)
    heat = problem_under_law(mesh, {"law": "constant", "closed": FALLING})
    state = open_pairs(mesh)[1]
    assert heat.coefficients([state])[0] == pytest.approx(960.0)  # 640 °C
    advanced(heat, mesh, [5.0])
    nodes = node_pairs(mesh, "casting", "mould").secondary_local
    faces = heat.temperature["casting"].x.array[nodes]
    expected = np.interp(faces, [0, 400, 800], [900, 1500, 600])
    assert heat.coefficients([state])[0] == pytest.approx(expected)


def test_parts_of_an_interface_have_their_own_laws(comm):
    mesh = cylinder(comm)
    pairs = node_pairs(mesh, "casting", "mould")
    upper = pairs.points[:, 1] > 0.03
    parts = [np.flatnonzero(~upper), np.flatnonzero(upper)]
    laws = [ConstantConductance(500.0), InterfaceHeat.read(SOLID).conduction_law()]
    law = PatchedLaw(list(zip(parts, laws, strict=True)))
    assert law.needs_solid_fraction
    heat = problem_under_law(mesh, law)
    state = open_pairs(mesh)[1]
    found = heat.coefficients([state])[0]
    assert found[~upper] == pytest.approx(500.0)
    closed = 900.0 + 600.0 * 250.0 / 400.0  # the mould is at 250 °C, nothing is solid
    assert found[upper] == pytest.approx(closed)


@pytest.mark.ranks
@pytest.mark.parametrize("linear", ["direct", "iterative"])
def test_linear_solvers_agree_where_a_whole_body_acts_on_every_pair(comm, linear):
    mesh = cylinder(comm)
    heat, reference = problem_under_law(mesh, SOLID, linear=linear), problem_under_law(mesh, SOLID)
    advanced(heat, mesh, [2.0, 10.0])
    advanced(reference, mesh, [2.0, 10.0])
    heats = [h.totals()["casting/mould.heat"] for h in (heat, reference)]
    assert heats[0] == pytest.approx(heats[1], rel=1e-7)


@pytest.mark.ranks
def test_mean_solid_fraction_and_its_derivative(comm):
    """Against the sum over all nodes, and differences of it along one direction."""
    balance = balance_under_law(cylinder(comm, size=8e-3), SOLID)
    feedback, body = balance.exchanges.feedback, balance.bodies[0]
    exchange, owned = feedback.exchanges[0], body.owned
    total = comm.allreduce(body.volumes.sum())

    def mean() -> float:
        local = body.volumes @ body.solid_fraction.x.array[:owned]
        return float(comm.allreduce(local) / total)

    assert 0.1 < mean() < 0.9
    assert feedback.means() == pytest.approx([mean(), 0.0])
    state = body.enthalpy.x.array[:owned].copy()
    direction = 1e3 * np.cos(np.arange(owned))
    ones, slope = balance.layout.create_vector(), balance.layout.create_vector()
    ones.array[:] = 1.0
    feedback.mean_slope(exchange, ones, slope)
    found = comm.allreduce(float(slope.array_r[balance.layout.local_slice(0)] @ direction))
    ends = []
    for sign in (1.0, -1.0):
        body.set_enthalpy(state + sign * direction)
        ends.append(mean())
    assert found == pytest.approx(0.5 * (ends[0] - ends[1]), rel=1e-6)
    assert (slope.array_r[balance.layout.local_slice(1)] == 0.0).all()


def test_perfect_contact_and_none_have_fixed_coefficients(comm):
    mesh = cylinder(comm, size=8e-3)
    state = open_pairs(mesh)[1]
    for kind, expected in (("perfect", np.inf), ("none", 0.0)):
        balance = balance_under_law(mesh, SERIES, kind=kind)
        assert (balance.coefficients([state])[0] == expected).all()
        assert not balance.exchanges.flows().any()


@pytest.mark.serial
def test_columns_complete_a_solution_as_in_dense_algebra():
    """(J + U Vᵀ) y = F with two columns, by the solver of J alone."""
    rng = np.random.default_rng(3)
    J, U, V = rng.normal(size=(7, 7)) + 9.0 * np.eye(7), rng.normal(size=(7, 2)), np.ones((7, 2))
    V[:, 1], F = rng.normal(size=7), rng.normal(size=7)
    matrix = PETSc.Mat().createDense((7, 7), array=J.copy(), comm=PETSc.COMM_SELF)
    solver = PETSc.KSP().create(PETSc.COMM_SELF)
    solver.setOperators(matrix)
    solver.setType("preonly")
    solver.pc.setType("lu")

    def vector(values):
        return PETSc.Vec().createWithArray(values.copy(), comm=PETSc.COMM_SELF)

    y = vector(np.linalg.solve(J, F))
    couple_step([(vector(U[:, k]), vector(V[:, k])) for k in range(2)], y, solver)
    np.testing.assert_allclose(y.array, np.linalg.solve(J + U @ V.T, F), rtol=1e-11)
