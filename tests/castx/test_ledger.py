from __future__ import annotations

import numpy as np
import pytest

from castx.ledger import Account, Ledger

pytestmark = pytest.mark.serial

ACCOUNTS = (Account("mould/outside.heat", 1), Account("casting/mould.heat", 1, 0))


def ledger() -> Ledger:
    return Ledger(("casting", "mould"), ACCOUNTS, np.array([100.0, 10.0]))


def test_heat_of_an_interface_leaves_one_body_and_enters_the_other():
    book = ledger()
    book.book(np.array([80.0, 25.0]), np.array([-5.0, 20.0]), 40.0)
    book.commit()
    totals = book.totals()
    assert totals["casting.heat_in"] == -20.0
    assert totals["mould.heat_in"] == 15.0
    assert totals["casting/mould.heat"] == 20.0
    assert totals["mould.enthalpy"] == 25.0
    assert totals["energy_error"] == 0.0


def test_errors_of_two_bodies_do_not_hide_each_other():
    book = ledger()
    book.book(np.array([81.0, 24.0]), np.array([-5.0, 20.0]), 40.0)
    book.commit()
    assert book.totals()["energy_error"] == pytest.approx(1 / 40)


def test_only_what_is_committed_counts():
    book = ledger()
    book.book(np.array([0.0, 0.0]), np.array([1.0, 2.0]), 3.0)
    assert book.totals()["casting.enthalpy"] == 100.0
    book.rewind()
    book.book(np.array([90.0, 20.0]), np.array([0.0, 10.0]), 10.0)
    book.commit()
    assert book.totals()["casting/mould.heat"] == 10.0
    assert book.totals()["energy_error"] == 0.0


def test_conditions_of_one_surface_add_up():
    accounts = (Account("mould/outside.heat", 0), Account("mould/outside.heat", 0))
    book = Ledger(("mould",), accounts, np.array([0.0]))
    book.book(np.array([3.0]), np.array([1.0, 2.0]), 3.0)
    book.commit()
    assert book.totals()["mould/outside.heat"] == 3.0


def test_nothing_happened():
    assert ledger().totals()["energy_error"] == 0.0
