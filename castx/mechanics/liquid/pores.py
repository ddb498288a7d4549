"""Whether each pocket of trapped liquid is full or has pores, from one iterate to the next."""

from __future__ import annotations

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.mechanics.liquid.content import Content
from castx.stateful import Arrays, Numbering, Saved

SLACK = 1e-9
"""Volumetric strain of the solid that counts as none when pores open or close."""

MOST_TURNS = 6
"""Changes of the state of one pocket in one solution; then it stays full."""

UNKNOWN, FULL, POROUS = -1, 0, 1


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
        # UNKNOWN in cells that are not trapped.
        self._committed: IntArray = np.full(len(numbering.numbers), UNKNOWN, dtype=np.int32)
        self._state: IntArray = self._committed

    def begin(self) -> None:
        """Guess the state of the pockets of a trial step; collective.

        It is that of the last iterate or, in a pocket that was none then, with pores if there would
        be a void without any motion.
        """
        known = self._content.largest(self._state)
        self.open = known == POROUS
        if (known == UNKNOWN).any():
            expected = self._content.expected_void_fraction() > SLACK
            self.open = np.where(known == UNKNOWN, expected, self.open)
        self._turns = np.zeros(len(self.open), dtype=np.int32)
        self._mark()

    def _mark(self) -> None:
        pocket = self._content.pocket
        self._state = np.full_like(pocket, UNKNOWN)
        self._state[pocket >= 0] = np.where(self.open, POROUS, FULL)[pocket[pocket >= 0]]

    @property
    def cells(self) -> BoolArray:
        """Whether the cells have pores, shape (cells,)."""
        return self._state == POROUS

    def turn(self, excess: FloatArray, void: FloatArray) -> bool:
        """Open pores where the pressure asks for it, close those without void; say whether any did.

        Args:
            excess: pressure above the one at which pores open, in strain of the solid, (pockets,).
            void: void fraction, shape (pockets,).
        """
        turned = np.where(self.open, void < -SLACK, excess > SLACK)
        # A pocket of a few cells may find neither state right, by an error of its mesh.
        turned &= self.open | (self._turns < MOST_TURNS)
        self.open = self.open ^ turned
        self._turns = self._turns + turned
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

    def rewind(self) -> None:
        """Return to the state of the last accepted step."""
        self._state = self._committed

    def saved(self) -> dict[str, Saved]:
        """Return the state of the last accepted step."""
        return {"state": Saved(self._committed, self._numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Restore it."""
        self._committed = np.asarray(arrays["state"], dtype=np.int32)
        self.rewind()
