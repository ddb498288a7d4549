"""Pockets of trapped liquid with pores, and their changes in an accepted step."""

from __future__ import annotations

import numpy as np

from castx.arrays import BoolArray, IntArray
from castx.mechanics.liquid.content import Content
from castx.stateful import Arrays, Numbering, Saved

SLACK = 1e-9
"""Void fraction that counts as none."""

UNKNOWN, FULL, POROUS = -1, 0, 1


class Pores:
    """The state of the pockets of one body; all cells of a pocket have the same.

    Args:
        content: of the body.
        numbering: of its cells.

    Attributes:
        open: whether each pocket has pores in the trial step, shape (pockets,).
    """

    def __init__(self, content: Content, numbering: Numbering) -> None:
        self._content, self._numbering = content, numbering
        self.open: BoolArray = np.zeros(0, dtype=bool)
        # UNKNOWN in cells that are not trapped.
        self._committed: IntArray = np.full(len(numbering.numbers), UNKNOWN, dtype=np.int32)

    def begin(self) -> None:
        """Begin a trial step with full pockets."""
        self.open = np.zeros(len(self._content.pockets), dtype=bool)

    def news(self) -> list[tuple[BoolArray, str]]:
        """Return the changes of an accepted step: flags of the pockets, and a text; collective."""
        before = self._content.largest(self._committed)
        return [
            (before == UNKNOWN, "of liquid that nothing feeds, and that resists compression"),
            (self.open & (before != POROUS), "of trapped liquid: pores open"),
            (~self.open & (before == POROUS), "of trapped liquid: its pores have closed"),
        ]

    def commit(self) -> None:
        """Keep the state of the trial step."""
        pocket = self._content.pocket
        self._committed = np.full_like(pocket, UNKNOWN)
        trapped = pocket >= 0
        self._committed[trapped] = np.where(self.open, POROUS, FULL)[pocket[trapped]]

    def saved(self) -> dict[str, Saved]:
        """Return the state of the last accepted step."""
        return {"state": Saved(self._committed, self._numbering)}

    def restore(self, arrays: Arrays) -> None:
        """Restore it."""
        self._committed = np.asarray(arrays["state"], dtype=np.int32)
