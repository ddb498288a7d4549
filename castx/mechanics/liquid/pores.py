"""Whether each pocket of trapped liquid is full or has pores, from one iterate to the next."""

from __future__ import annotations

from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.mechanics.liquid.content import Content
from castx.stateful import Arrays, Numbering, Saved

SLACK = 1e-9
"""Volumetric strain of the solid that counts as none when pores open or close."""

MOST_TURNS = 2
"""Changes of the state of one pocket in one step, all passes together; then it stays full."""

UNKNOWN, FULL, POROUS = -1, 0, 1

Entry = TypeVar("Entry", bound=np.generic)


class Pores:
    """The state of the pockets of one body; all cells of a pocket have the same.

    Args:
        content: of the body.
        numbering: of its cells.

    Attributes:
        open: whether each pocket has pores, shape (pockets,).
    """

    def __init__(self, content: Content, numbering: Numbering) -> None:
        self._content, self._numbering = content, numbering
        self.open: BoolArray = np.zeros(0, dtype=bool)
        self._turns: IntArray = np.zeros(0, dtype=np.int32)
        self._guessed: BoolArray = np.zeros(0, dtype=bool)
        # UNKNOWN in cells that are not trapped.
        self._committed: IntArray = np.full(len(numbering.numbers), UNKNOWN, dtype=np.int32)
        self._state: IntArray = self._committed
        # Changes in this step, of each cell.
        self._turned: IntArray = np.zeros(len(numbering.numbers), dtype=np.int32)

    def begin(self) -> None:
        """Guess the state of the pockets of a trial step; collective.

        It is that of the last iterate or, in a pocket that was none then, with pores if there would
        be a void without any motion; the first iterate corrects that.
        """
        known = self._content.largest(self._state)
        self.open, self._guessed = known == POROUS, known == UNKNOWN
        if self._guessed.any():
            expected = self._content.expected_void_fraction() > SLACK
            self.open = np.where(self._guessed, expected, self.open)
        self._turns = self._content.largest(self._turned).astype(np.int32)
        self._mark()

    def _mark(self) -> None:
        unknown = np.full_like(self._content.pocket, UNKNOWN)
        self._state = self._spread(np.where(self.open, POROUS, FULL), unknown)
        self._turned = self._spread(self._turns, self._turned)

    def _spread(
        self, values: npt.NDArray[Any], cells: npt.NDArray[Entry]
    ) -> npt.NDArray[Entry]:
        """Return a copy of what cells have, with values of pockets in those that are trapped."""
        pocket, spread = self._content.pocket, cells.copy()
        trapped = pocket >= 0
        spread[trapped] = values[pocket[trapped]]
        return spread

    @property
    def cells(self) -> BoolArray:
        """Whether the cells have pores, shape (cells,)."""
        return self._state == POROUS

    def turn(self, excess: FloatArray, void: FloatArray, settled: bool = True) -> bool:
        """Open pores where the pressure asks for it, close those without void; say whether any did.

        What a shell that has yet to yield says of void and pressure holds for a guess alone: the
        sign of either is that of the first linear system.

        Args:
            excess: pressure above the one at which pores open, in strain of the solid, (pockets,).
            void: void fraction, shape (pockets,).
            settled: whether forces nearly balance.
        """
        guessed, self._guessed = self._guessed, np.zeros_like(self._guessed)
        turned = np.where(self.open, void < -SLACK, excess > SLACK)
        # What yields may find neither state right on its way to balance.
        turned &= self.open | (self._turns < MOST_TURNS)
        turned &= settled | guessed
        self.open = self.open ^ turned
        self._turns = self._turns + (turned & settled)
        self._mark()
        return bool(turned.any())

    def news(self) -> list[tuple[BoolArray, str]]:
        """Return what an accepted step has changed: in which pockets, and in words; collective."""
        before = self._content.largest(self._committed)
        return [
            (before == UNKNOWN, "of liquid cannot be fed any more, and resist compression"),
            (self.open & (before != POROUS), "of trapped liquid: pores open"),
            (~self.open & (before == POROUS), "of trapped liquid: its pores have closed"),
        ]

    def commit(self) -> None:
        """Keep the state of the trial step."""
        self._committed = self._state
        self._turned[:] = 0

    def rewind(self) -> None:
        """Return to the state of the last accepted step."""
        self._state = self._committed
        self._turned[:] = 0

    def saved(self) -> dict[str, Saved]:
        """Return the state of the last accepted step."""
        return {"state": Saved(self._committed, self._numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Restore it."""
        self._committed = np.asarray(arrays["state"], dtype=np.int32)
        self.rewind()
