"""Pores of three pockets: what is said of them, what is kept."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.mechanics.liquid.content import Content
from castx.mechanics.liquid.feeding_paths import CutOff
from castx.mechanics.liquid.pores import Pores
from castx.stateful import Numbering

pytestmark = pytest.mark.serial

NUMBERING = Numbering("cells of casting", np.arange(4), 4, ("casting",))
POCKET = np.array([0, 1, 2, -1], dtype=np.int32)


def pores() -> Pores:
    """Return the pores of three pockets, each of one cell, in a trial step."""
    content = Content(MPI.COMM_SELF, NUMBERING, np.ones(4))
    none, liquid = np.zeros(4), POCKET >= 0
    content.begin(CutOff.throughout(POCKET), liquid, none, none, none)
    made = Pores(content, NUMBERING)
    made.begin()
    return made


def told(found: Pores) -> list[list[bool]]:
    return [[bool(each) for each in which] for which, _ in found.news()]


def test_a_trial_step_begins_full() -> None:
    found = pores()
    assert found.open.tolist() == [False] * 3
    found.open = np.array([True, False, True])
    found.begin()
    assert not found.open.any()


def test_what_is_new_is_told_once_a_step_is_accepted() -> None:
    found = pores()
    found.open = np.array([True, False, False])
    assert told(found) == [[True] * 3, [True, False, False], [False] * 3]
    found.commit()
    assert told(found) == [[False] * 3, [False] * 3, [False] * 3]
    found.begin()
    found.open = np.array([False, True, False])
    assert told(found) == [[False] * 3, [False, True, False], [True, False, False]]
    found.begin()  # taken back, it is tried again
    assert told(found) == [[False] * 3, [False] * 3, [True, False, False]]


def test_the_state_of_the_last_step_comes_back() -> None:
    found, other = pores(), pores()
    found.open = np.array([True, False, True])
    found.commit()
    saved = {name: part.values for name, part in found.saved().items()}
    assert saved["state"].tolist() == [1, 0, 1, -1]
    other.restore(saved)
    for each in (found, other):
        each.begin()
        assert told(each) == [[False] * 3, [False] * 3, [True, False, True]]
