"""State of three pockets: when pores open and close, what is said, what is kept."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.mechanics.liquid.content import Content
from castx.mechanics.liquid.pores import MOST_TURNS, Pores
from castx.stateful import Numbering

pytestmark = pytest.mark.serial

NUMBERING = Numbering("cells of casting", np.arange(4), 4, ("casting",))
POCKET = np.array([0, 1, 2, -1], dtype=np.int32)
NOTHING = np.zeros(3)


def pores(*shrunk: float) -> Pores:
    """Return the pores of three pockets, each of one cell, that have shrunk in the step."""
    content = Content(MPI.COMM_SELF, NUMBERING, np.ones(4))
    none, liquid = np.zeros(4), POCKET >= 0
    content.begin(POCKET, liquid, none, none)
    content.begin(POCKET, liquid, np.array([*shrunk, 0.0]), none)
    made = Pores(content, NUMBERING)
    made.begin()
    return made


def test_a_new_pocket_is_expected_to_have_pores_where_its_liquid_shrinks() -> None:
    found = pores(0.01, 0.0, -0.01)
    assert found.open.tolist() == [True, False, False]
    assert found.cells.tolist() == [True, False, False, False]


def test_pressure_opens_and_a_negative_void_closes() -> None:
    """Pressure counts where there are no pores, and void where there are."""
    found = pores(0.01, 0.01, 0.0)
    assert not found.turn(np.array([5.0, 5.0, 0.0]), np.array([0.01, 0.0, 9.0]))
    assert found.turn(np.array([0.0, 0.0, 1e-6]), np.array([0.01, -1e-6, 0.0]))
    assert found.open.tolist() == [True, False, True]
    assert not found.turn(np.array([1e-6, -1e-6, 0.0]), np.array([0.0, -1.0, 0.01]))


def test_the_first_iterate_corrects_a_guess_although_nothing_has_settled() -> None:
    """Once, and beside the turns that a step may take."""
    found = pores(0.01, 0.0, 0.0)
    excess, void = np.array([0.0, 1e-3, 0.0]), np.array([-1e-3, 0.0, 0.0])
    assert found.turn(excess, void, settled=False)
    assert found.open.tolist() == [False, True, False]
    assert not found.turn(excess[[1, 0, 2]], void[[1, 0, 2]], settled=False)
    found.commit()
    found.begin()  # what a step has settled is no guess
    assert not found.turn(excess[[1, 0, 2]], void[[1, 0, 2]], settled=False)
    turns = 0
    while found.turn(np.full(3, 1e-3), np.full(3, -1e-3)):
        turns += 1
    assert turns >= MOST_TURNS


def test_who_finds_neither_state_right_stays_full() -> None:
    found = pores(0.0, 0.0, 0.0)
    turns = 0
    while found.turn(np.array([1e-3, 0.0, 0.0]), np.array([-1e-3, 0.0, 0.0])):
        turns += 1
    assert turns == MOST_TURNS < 20 and not found.open.any()  # long before a solution gives up


def test_turns_count_over_all_passes_of_a_step():
    """Else each pass would find its pockets in both states once more."""
    found = pores(0.0, 0.0, 0.0)
    drawn, pressed = np.array([1e-3, 0.0, 0.0]), np.array([-1e-3, 0.0, 0.0])
    for ending in (found.rewind, found.commit):
        assert found.turn(drawn, NOTHING) and found.turn(NOTHING, pressed)
        found.begin()  # another pass
        assert not found.turn(9 * drawn, NOTHING) and not found.open.any()
        ending()
        found.begin()
    assert found.turn(9 * drawn, NOTHING)


def test_a_next_step_tries_pores_again_that_had_no_void():
    """By the same pressure, after a step that was accepted, taken back or restored."""
    found = pores(0.0, 0.0, 0.0)
    drawn, pressed = np.array([1e-3, 0.0, 0.0]), np.array([-1e-3, 0.0, 0.0])
    for ending in (found.rewind, found.commit):
        assert found.turn(drawn, NOTHING) and found.turn(NOTHING, pressed)
        ending()
        found.begin()
        assert not found.open.any()
    other = pores(0.0, 0.0, 0.0)
    other.restore({name: saved.values for name, saved in found.saved().items()})
    for made in (found, other):
        made.begin()
        assert made.turn(drawn, NOTHING) and made.open.tolist() == [True, False, False]
        assert made.cells.tolist() == [True, False, False, False]


def test_a_step_that_is_taken_back_leaves_nothing_behind() -> None:
    found = pores(0.0, 0.0, 0.0)
    assert [which.tolist() for which, _ in found.news()] == [[True] * 3, [False] * 3, [False] * 3]
    found.commit()
    found.turn(np.array([1e-3, 0.0, 0.0]), NOTHING)
    assert [which.tolist() for which, _ in found.news()] == [
        [False] * 3, [True, False, False], [False] * 3
    ]  # fmt: skip
    found.begin()
    assert found.open.tolist() == [True, False, False]  # the last iterate is the next guess
    found.rewind()
    found.begin()
    assert not found.open.any()
    other = pores(0.01, 0.01, 0.01)
    other.restore({name: saved.values for name, saved in found.saved().items()})
    other.begin()
    assert not other.open.any()
    found.turn(np.ones(3), NOTHING)
    found.commit()
    found.turn(NOTHING, -np.ones(3))
    assert [which.any() for which, _ in found.news()] == [False, False, True]
