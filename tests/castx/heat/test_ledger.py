"""Book-keeping of heat: accounts, trial and committed numbers, stages."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.heat.ledger import Account, Accounts, HeatBooks, Ledger, accounts_of, joined_accounts

pytestmark = pytest.mark.serial

ACCOUNTS = (
    Account.through("mould/outside", "convection", "mould"),
    Account.through("casting/mould", "contact", "mould", "casting"),
)


def of(bodies: tuple[str, ...], accounts: tuple[Account, ...], *enthalpy: float) -> Ledger:
    return Ledger(Accounts(bodies, accounts), bodies, accounts, np.array(enthalpy))


def ledger() -> Ledger:
    return of(("casting", "mould"), ACCOUNTS, 100.0, 10.0)


def test_heat_of_an_interface_leaves_one_body_and_enters_the_other():
    book = ledger()
    book.book(np.array([80.0, 25.0]), np.array([-5.0, 20.0]), 40.0, 2.0)
    book.commit()
    totals = book.totals()
    assert totals["casting.heat_in"] == -20.0
    assert totals["mould.heat_in"] == 15.0
    assert totals["casting/mould.heat"] == 20.0
    assert totals["mould.enthalpy"] == 25.0
    assert totals["energy_error"] == 0.0


def test_errors_of_two_bodies_do_not_hide_each_other():
    book = ledger()
    book.book(np.array([81.0, 24.0]), np.array([-5.0, 20.0]), 40.0, 2.0)
    book.commit()
    assert book.totals()["energy_error"] == pytest.approx(1 / 40)


def test_errors_of_small_bodies_are_measured_by_the_little_that_moves():
    book = of(("casting", "mould"), ACCOUNTS, 100e-6, 10e-6)
    book.book(np.array([81e-6, 24e-6]), np.array([-5e-6, 20e-6]), 40e-6, 2.0)
    book.commit()
    assert book.totals()["energy_error"] == pytest.approx(1 / 40)


def test_only_what_is_committed_counts():
    book = ledger()
    book.book(np.array([0.0, 0.0]), np.array([1.0, 2.0]), 3.0, 2.0)
    assert book.totals()["casting.enthalpy"] == 100.0
    book.rewind()
    book.book(np.array([90.0, 20.0]), np.array([0.0, 10.0]), 10.0, 2.0)
    book.commit()
    assert book.totals()["casting/mould.heat"] == 10.0
    assert book.totals()["energy_error"] == 0.0


def test_conditions_of_one_surface_add_up():
    accounts = (
        Account.through("mould/outside", "convection", "mould"),
        Account.through("mould/outside", "radiation", "mould"),
    )
    book = of(("mould",), accounts, 0.0)
    book.book(np.array([3.0]), np.array([1.0, 2.0]), 3.0, 2.0)
    book.commit()
    totals = book.totals()
    assert totals["mould/outside.heat"] == 3.0
    assert totals["mould/outside.heat.convection"] == 1.0
    assert totals["mould/outside.heat.radiation"] == 2.0
    assert totals["mould/outside.power"] == 1.5
    assert totals["mould/outside.power.radiation"] == 1.0


def test_power_is_the_mean_over_the_last_step():
    book = ledger()
    book.book(np.array([80.0, 25.0]), np.array([-5.0, 20.0]), 25.0, 1.0)
    book.commit()
    for heat in (6.0, 10.0):  # two sub-steps
        book.book(np.array([80.0, 25.0]), np.array([0.0, heat]), heat, 2.0)
    assert book.totals()["casting/mould.power"] == 20.0  # nothing is committed yet
    book.commit()
    totals = book.totals()
    assert totals["casting/mould.power.contact"] == totals["casting/mould.power"] == 4.0
    assert (totals["casting.power"], totals["mould.power"]) == (-4.0, 4.0)
    assert totals["mould/outside.power"] == 0.0
    book.book(np.array([0.0, 0.0]), np.array([1.0, 1.0]), 1.0, 5.0)
    book.rewind()
    book.book(np.array([80.0, 25.0]), np.array([0.0, 3.0]), 3.0, 1.0)
    book.commit()
    assert book.totals()["casting/mould.power"] == 3.0


def test_sources_have_their_own_names():
    book = of(("feeder",), (Account.source("feeder"),), 0.0)
    book.book(np.array([8.0]), np.array([8.0]), 8.0, 2.0)
    book.commit()
    totals = book.totals()
    assert (totals["feeder.source"], totals["feeder.power.source"]) == (8.0, 4.0)
    assert totals["feeder.heat_in"] == 8.0


def test_nothing_happened():
    assert ledger().totals()["energy_error"] == 0.0


RUN = Accounts(("casting", "mould"), (*ACCOUNTS, Account.renewal("casting")))


def test_what_is_gone_keeps_its_heat_and_another_stage_goes_on():
    first = Ledger(RUN, RUN.bodies, ACCOUNTS, np.array([100.0, 10.0]))
    first.book(np.array([80.0, 25.0]), np.array([-5.0, 20.0]), 40.0, 2.0)
    first.commit()
    second = Ledger(RUN, ["mould"], ACCOUNTS[:1], np.array([-1.0]))
    second.restore({name: saved.values for name, saved in first.saved().items()})
    second.book(np.array([19.0]), np.array([-6.0]), 6.0, 3.0)
    second.commit()
    totals = second.totals()
    assert totals["casting.enthalpy"] == 80.0
    assert totals["mould/outside.heat"] == -11.0
    assert totals["casting/mould.heat"] == 20.0
    assert totals["casting/mould.power"] == totals["casting.power"] == 0.0
    assert totals["mould.power"] == -2.0
    assert totals["energy_error"] == 0.0


def test_a_new_casting_brings_heat():
    book = Ledger(RUN, RUN.bodies, ACCOUNTS, np.array([100.0, 10.0]))
    book.book(np.array([80.0, 30.0]), np.array([0.0, 20.0]), 20.0, 2.0)
    book.commit()
    book.renew(np.array([100.0, 30.0]))
    book.commit()
    totals = book.totals()
    assert totals["casting.renewal"] == 20.0
    assert totals["casting.enthalpy"] == 100.0
    assert totals["energy_error"] == 0.0
    assert totals["casting/mould.power"] == 10.0


class StoringBody:
    """A body whose heat is set by hand."""

    def __init__(self, name: str, heat: float) -> None:
        self.name, self.heat = name, heat

    def stored_heat(self) -> float:
        return self.heat


def test_a_stage_begins_with_renewed_bodies_and_heat_that_evens_out():
    """A new casting brings 60 J more than the old one kept; perfect contact passes 15 J at once."""
    bodies: Any = [StoringBody("casting", 40.0), StoringBody("mould", 10.0)]
    own = accounts_of(["casting", "mould"], [], [("casting", "mould")], ())
    run = joined_accounts(["casting", "mould"], [own, [Account.renewal("casting")]])
    books = HeatBooks(MPI.COMM_SELF, bodies, own, run)
    bodies[0].heat = 100.0

    def equalise() -> FloatArray:
        bodies[0].heat, bodies[1].heat = 85.0, 25.0
        return np.array([15.0])

    books.begin_stage(equalise)
    books.ledger.commit()
    totals = books.ledger.totals()
    assert totals["casting.renewal"] == 60.0
    assert totals["casting/mould.heat.contact"] == totals["casting/mould.heat"] == 15.0
    assert (totals["casting.enthalpy"], totals["mould.enthalpy"]) == (85.0, 25.0)
    assert totals["energy_error"] == 0.0
    flows = np.zeros(len(own))
    flows[own.index(Account.source("casting"))] = 4.0
    bodies[0].heat = 93.0
    books.book(flows, 4.0, 2.0)
    books.ledger.commit()
    totals = books.ledger.totals()
    assert (totals["casting.source"], totals["casting.power.source"]) == (8.0, 4.0)
    assert totals["energy_error"] == 0.0
