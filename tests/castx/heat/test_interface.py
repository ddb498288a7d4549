"""Exchange between the nodes of one interface: action and reaction, states within a step."""

from __future__ import annotations

import numpy as np
import pytest

from castx.transfer.conductance import ConstantConductance
from castx.transfer.radiation import STEFAN_BOLTZMANN
from tests.castx.heat.heat_cases import (
    SERIES,
    balance_under_law,
    cylinder,
    open_pairs,
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
    h = 1.0 / (0.7 / exchange.coefficient(start) + 0.3 * factor / exchange.coefficient(end))
    balance.exchanges.set_states([(end, end)], 1.0)
    balance.exchanges.update_faces(balance.unknowns.temperature, 1.0)
    drop = exchange.heat().sum(axis=0) / (exchange.areas * exchange.coefficient(end))
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
