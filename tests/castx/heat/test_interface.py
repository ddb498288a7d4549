"""Exchange between facing nodes: action and reaction, states within a step, mechanisms, parts."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.domain.pairs.node_pairs import node_pairs
from castx.heat.interface import HeatExchange, coefficients
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


def exchange_at(mesh, law, radiation, part, factor=None):
    """Return the exchange of an interface at the present temperatures, with its balance."""
    balance = balance_under_law(mesh, law, radiation)
    balance.exchanges.set_states([open_pairs(mesh, 1e-5, 2e-4)], part, factor)
    balance.unknowns.read_temperatures()
    balance.exchanges.update_faces(balance.unknowns.temperature, 1.0)
    return balance, balance.exchanges.under_law[0]


def test_what_leaves_one_side_enters_the_other(comm):
    balance, exchange = exchange_at(cylinder(comm, size=8e-3), SERIES, 0.4, 0.5)
    taken = balance.layout.create_vector()
    heat = exchange.heat().sum(axis=0)
    exchange.add_heat(heat, taken)
    sides = [comm.allreduce(taken.array_r[balance.layout.local_slice(k)].sum()) for k in (0, 1)]
    assert sides[0] == pytest.approx(comm.allreduce(heat.sum()), rel=1e-12)
    assert sides[1] == pytest.approx(-sides[0], rel=1e-12) and sides[0] > 0.0


def test_the_resistance_goes_straight_over_the_step(comm):
    """At three tenths of the step: 1/h = 0.7/h_start + 0.3/h_end, with a factor at the end."""
    mesh = cylinder(comm, size=8e-3)
    count = len(open_pairs(mesh)[0].gap)
    factor = np.linspace(0.5, 2.0, count)
    balance, exchange = exchange_at(mesh, SERIES, None, 0.3, [factor])
    start, end = open_pairs(mesh, 1e-5, 2e-4)
    h_start, h_end = (exchange.law(s, exchange.faces).coefficient.value for s in (start, end))
    h = 1.0 / (0.7 / h_start + 0.3 * factor / h_end)
    balance.exchanges.set_states([(end, end)], 1.0)
    balance.exchanges.update_faces(balance.unknowns.temperature, 1.0)
    drop = exchange.heat().sum(axis=0) / (exchange.areas * h_end)
    balance.exchanges.set_states([(start, end)], 0.3, [factor])
    balance.exchanges.update_faces(balance.unknowns.temperature, 1.0)
    np.testing.assert_allclose(exchange.heat().sum(axis=0), exchange.areas * h * drop, rtol=1e-12)


def test_nothing_passes_where_the_law_conducts_nothing(comm):
    _, exchange = exchange_at(cylinder(comm, size=8e-3), ConstantConductance(), None, 0.3)
    assert not exchange.heat().any()


def test_mechanisms_have_their_shares(comm):
    """Open pairs conduct through the gas; radiation is that of Stefan and Boltzmann."""
    balance, exchange = exchange_at(cylinder(comm, size=8e-3), {"law": "none"}, 0.4, 1.0)
    contact, gas, radiated = exchange.heat()
    assert not contact.any() and not gas.any()
    casting, mould = balance.bodies
    powers = []
    for body in (casting, mould):
        nodes = body.mesh.surface_nodes("mould" if body is casting else "casting")
        nodes = nodes[nodes < body.owned]
        _, areas = body.surface_areas("mould" if body is casting else "casting")
        T = body.owned_temperature[nodes] + 273.15
        powers.append(comm.allreduce(float(areas @ T**4)))
    expected = 0.4 * STEFAN_BOLTZMANN * (powers[0] - powers[1])
    assert comm.allreduce(radiated.sum()) == pytest.approx(expected, rel=1e-9)
    _, open_exchange = exchange_at(cylinder(comm, size=8e-3), SERIES, None, 1.0)
    shares = open_exchange.heat()
    assert comm.allreduce(shares[0].sum()) == 0.0 < comm.allreduce(shares[1].sum())


def test_pairs_that_open_in_a_step_conduct_by_contact_for_its_first_part(comm):
    """Closed at its start, open at its end: at three tenths of it seven tenths touch."""
    mesh = cylinder(comm, size=8e-3)
    balance = balance_under_law(mesh, SERIES, None)
    start, end = open_pairs(mesh, 0.0, 2e-4)
    balance.exchanges.set_states([(start, end)], 0.3)
    balance.unknowns.read_temperatures()
    balance.exchanges.update_faces(balance.unknowns.temperature, 1.0)
    contact, gas, _ = balance.exchanges.under_law[0].heat()
    assert start.closed.all()
    share = 0.7 * start.closed + 0.3 * end.closed
    np.testing.assert_allclose(contact, share * (contact + gas), rtol=1e-12)
    assert comm.allreduce(float(gas.sum())) > 0.0


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


def test_perfect_contact_and_none_have_fixed_coefficients(comm):
    mesh = cylinder(comm, size=8e-3)
    state = open_pairs(mesh)[1]
    for kind, expected in (("perfect", np.inf), ("none", 0.0)):
        balance = balance_under_law(mesh, SERIES, kind=kind)
        faces = balance.exchanges.faces_at(balance.unknowns.temperature, 0.0)
        described = [HeatExchange("casting/mould", node_pairs(mesh, "casting", "mould"), kind)]
        assert (coefficients(described, faces, [state])[0] == expected).all()
        assert not balance.exchanges.flows().any()


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
