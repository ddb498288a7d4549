"""Which saved arrays and totals a stage hands to the next one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from castx.process.handover import handed_over, left_total, without
from castx.stateful import Numbering, Saved, joined, number
from tests.castx.process.test_stages import FLOWING
from tests.coupled_cases import merged, ring, simulation

pytestmark = pytest.mark.serial

OF_THE_RUN = {"interfaces/step", "mechanics/time"}
"""Numbers that belong to no body; the ledger of heat keeps the accounts of the whole run."""


def of(*bodies: str) -> Saved:
    return Saved(np.zeros(2), Numbering("nodes", np.arange(2), 2, bodies))


def test_arrays_of_renewed_bodies_and_of_the_cycle_stay_behind():
    state = {
        "kept": of("mould"), "new": of("casting"), "between": of("casting", "mould"),
        "volume": number(1.0, bodies=("casting",)), "ledger": number(2.0),
        "time": number(3.0, of_cycle=True),
    }  # fmt: skip
    assert without(state, ["casting"]).keys() == {"kept", "ledger"}
    assert without(state, []).keys() == state.keys() - {"time"}


def rows(numbers, *values: float) -> Saved:
    return Saved(np.array(values), Numbering("rows", np.array(numbers), len(numbers), ("core",)))


def test_rows_find_their_values_by_their_numbers():
    """Further rows begin anew, and rows that are no more are forgotten."""
    fresh = rows([3, 5, 8, 9], -1.0, -2.0, -3.0, -4.0)
    np.testing.assert_array_equal(
        handed_over(rows([5, 7, 3], 50.0, 70.0, 30.0), fresh), [30.0, 50.0, -3.0, -4.0]
    )
    same_size = handed_over(rows([3, 5, 7, 9], 30.0, 50.0, 70.0, 90.0), fresh)
    np.testing.assert_array_equal(same_size, [30.0, 50.0, -3.0, 90.0])
    np.testing.assert_array_equal(fresh.values, [-1.0, -2.0, -3.0, -4.0])


def test_numbers_without_entities_go_on():
    assert handed_over(number(5.0), number(0.0)) == 5.0


def test_renaming_a_part_changes_nothing():
    """Arrays know their bodies themselves, whatever the parts that hold them are called."""
    state = {"a": of("casting"), "b": of("mould")}
    renamed = joined({"another part": state})
    assert without(renamed, ["casting"]).keys() == {"another part/b"}


def test_every_array_of_a_coupled_problem_knows_its_bodies(comm):
    """An array without owners would survive the body that it belongs to."""
    run = simulation(comm, merged(ring(), {"materials": {"aluminium": FLOWING}}))
    saved = run.problem.saved()
    ownerless = {name for name, array in saved.items() if not array.owners}
    assert {name for name in ownerless if not name.startswith("heat/ledger/")} == OF_THE_RUN
    for name, array in saved.items():
        named = {body for body in ("casting", "core") if body in name.split("/")}
        assert named == set(array.owners), name
    kept = without(saved, ["casting"])
    assert {array.owners for array in kept.values()} == {(), ("core",)}
    assert "mechanics/time" not in kept
    run.destroy()


@pytest.mark.parametrize(
    "name, left",
    [
        ("casting.enthalpy", 5.0),
        ("casting/mould.heat", 5.0),
        ("casting/mould.power.radiation", 0.0),
        ("casting/mould.force.z", 0.0),
        ("casting/mould.closed_fraction", 0.0),
        ("casting.ejection_force", 0.0),
        ("casting.force_error", 0.0),
        ("die/back.clamp_force", 0.0),
        ("die/back.clamp_displacement", 5.0),
        ("casting.support_force.x", 0.0),
        ("casting.support_moment.z", 0.0),
        ("mould/casting.surface.power.radiation", 0.0),
        ("mould/casting.surface.heat", 5.0),
        ("support_force", 0.0),
        ("largest_pull", 0.0),
        ("casting/mould.mean_gap", math.nan),
        ("mould.max_temperature", math.nan),
        ("casting/mould.min_gap", math.nan),
        ("casting/mould.max_gap", math.nan),
        ("energy_error", 5.0),
    ],
)
def test_amounts_stay_and_forces_end_with_a_body(name, left):
    assert left_total(name, 5.0) == pytest.approx(left, nan_ok=True)
