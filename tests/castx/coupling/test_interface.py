"""States of pairs between the steps: what heat sees of them under each scheme."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from castx.coupling.interface import CoupledInterface, Interfaces
from castx.stateful import Numbering
from castx.transfer.pair_state import PairState

pytestmark = pytest.mark.serial

SCHEMES = ("thermal", "mechanical", "one-way", "staggered", "iterated")
FEEDBACK = ("staggered", "iterated")
START = np.array([0.0, 1e-4, -2e-5])
AREAS = np.array([1e-6, 2e-6, 4e-6])


def described(name: str, contact: int | None, clearance: float = 0.0) -> CoupledInterface:
    numbering = Numbering(f"pairs of {name}", np.arange(3), 3, tuple(name.split("/")))
    pairs = SimpleNamespace(
        area_vectors=np.ones((3, 2)), areas=AREAS, numbering=numbering, gap=START
    )
    return CoupledInterface(name, pairs, contact, clearance)  # type: ignore[arg-type]


def interfaces(scheme: str) -> Interfaces:
    """Return an interface without contact and one with."""
    parts = [described("casting/core", None), described("casting/mould", 0)]
    found = Interfaces(parts, scheme)
    found.begin([np.full(3, 1e-3), np.full(3, 2e-3)])
    return found


def test_areas_follow_the_order_of_the_interfaces():
    np.testing.assert_array_equal(interfaces("iterated").areas, [*AREAS, *AREAS])
    assert len(Interfaces([], "iterated").areas) == 0


def moved(gap):
    return PairState(
        np.array([gap, -1e-12, 2 * gap]), np.array([0.0, 5e6, -1.0]),
        np.array([False, True, False]), np.arange(6.0).reshape(3, 2), np.zeros(3),
    )  # fmt: skip


def test_nothing_presses_at_first_and_interference_is_closed():
    state = interfaces("iterated").states[1]
    np.testing.assert_array_equal(state.gap, START)
    np.testing.assert_array_equal(state.closed, [True, False, True])
    assert not state.pressure.any() and not state.force.any()
    assert state.force.shape == (3, 2)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_heat_sees_the_present_pairs_only_with_feedback(scheme):
    found = interfaces(scheme)
    before = [state.gap for state in found.thermal()]
    found.update([moved(3e-5)])
    np.testing.assert_array_equal(found.states[0].gap, START)  # no contact is computed there
    np.testing.assert_array_equal(found.states[1].force, moved(3e-5).force)
    seen = found.thermal()[1]
    if scheme in FEEDBACK:
        np.testing.assert_array_equal(seen.gap, [3e-5, 0.0, 6e-5])
        np.testing.assert_array_equal(seen.pressure, [0.0, 5e6, 0.0])
    else:
        np.testing.assert_array_equal(seen.gap, before[1])
    np.testing.assert_array_equal(found.thermal_at_start()[1].gap, [0.0, 1e-4, 0.0])


@pytest.mark.parametrize("scheme", FEEDBACK)
def test_the_first_guess_of_the_iteration_extrapolates_the_gaps(scheme):
    found = interfaces(scheme)
    for gap in (1e-5, 4e-5):
        found.update([moved(gap)])
        found.commit(2.0)
    guess = found.first_guess(1.0)[1]
    expected = [5.5e-5, 0.0, 11e-5] if scheme == "iterated" else [4e-5, 0.0, 8e-5]
    np.testing.assert_allclose(guess.gap, expected, rtol=1e-12)
    np.testing.assert_array_equal(guess.pressure, [0.0, 5e6, 0.0])


def test_heat_counts_gaps_from_where_the_surfaces_cease_to_touch():
    found = Interfaces([described("casting/mould", 0, clearance=2e-5)], "iterated")
    np.testing.assert_allclose(found.thermal()[0].gap, [0.0, 8e-5, 0.0], rtol=1e-12)
    for gap in (3e-5, 5e-5):
        found.update([moved(gap)])
        found.commit(2.0)
    np.testing.assert_allclose(found.thermal()[0].gap, [3e-5, 0.0, 8e-5], rtol=1e-12)
    np.testing.assert_allclose(found.first_guess(1.0)[0].gap, [4e-5, 0.0, 10e-5], rtol=1e-12)
    np.testing.assert_array_equal(found.states[0].gap, [5e-5, -1e-12, 10e-5])
    found.update([moved(1e-5)])
    assert found.thermal()[0].closed.all()
    assert found.largest_change() == pytest.approx(8e-5), "all that is open closes"


def test_a_gap_that_would_become_negative_is_closed_in_the_guess():
    found = interfaces("iterated")
    for gap in (4e-5, 1e-5):
        found.update([moved(gap)])
        found.commit(1.0)
    guess = found.first_guess(1.0)[1]
    np.testing.assert_array_equal(guess.gap, 0.0)
    assert guess.closed.all()


def test_a_rewind_takes_states_and_resistances_back():
    found = interfaces("iterated")
    found.update([moved(1e-5)])
    found.resistances = [np.full(3, 7.0), np.full(3, 8.0)]
    found.rewind()
    np.testing.assert_array_equal(found.states[1].gap, START)
    np.testing.assert_array_equal(found.resistances[1], 2e-3)
    found.update([moved(1e-5)])
    found.commit(0.5)
    found.rewind()
    np.testing.assert_array_equal(found.states[1].gap, moved(1e-5).gap)
    assert found.committed_step == 0.5


def test_saved_states_come_back():
    found, other = interfaces("iterated"), interfaces("iterated")
    for gap in (1e-5, 4e-5):
        found.update([moved(gap)])
        found.resistances = [np.full(3, gap), np.full(3, 2 * gap)]
        found.commit(2.0)
    saved = found.saved()
    assert {name.rpartition("/")[2] for name in saved} == {
        "step", "gap", "pressure", "closed", "force", "suction", "resistance", "gap_rate"
    }  # fmt: skip
    other.restore({name: array.values for name, array in saved.items()})
    other.rewind()
    assert other.committed_step == 2.0
    for one, two in zip(found.states, other.states, strict=True):
        for name in ("gap", "pressure", "closed", "force"):
            np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
    np.testing.assert_array_equal(other.resistances[1], 8e-5)
    np.testing.assert_array_equal(other.first_guess(1.0)[1].gap, found.first_guess(1.0)[1].gap)


def test_interfaces_are_found_by_name():
    assert interfaces("iterated").number("casting/mould") == 1


def test_the_largest_change_is_that_of_an_open_gap():
    found = interfaces("iterated")
    assert found.largest_change() == 0.0
    found.states[1] = moved(3e-4)
    assert found.largest_change() == pytest.approx(6e-4), "from a pair that was pressed together"
    found.commit(1.0)
    found.states[1] = moved(4e-4)
    assert found.largest_change() == pytest.approx(2e-4)
    found.rewind()
    assert found.largest_change() == 0.0
    assert Interfaces([], "iterated").largest_change() == 0.0
