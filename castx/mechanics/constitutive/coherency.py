"""Solid fractions of the cells in the passes of a step between heat and mechanics.

A cell is solid from coherency on, and contracts at once by what its nodes have cooled until then.
Where this opens a gap that delays its freezing, no pass agrees with the next: as a liquid the cell
freezes, as a solid it does not. A cell that becomes solid for the second time within a step keeps
the solid fraction that it has then as the least one until the end of the step.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray

FIRST_LASTING = 2
"""Birth within a step from which on a cell stays solid: the first pass may freeze too much."""


class Coherency:
    """Counts how often the cells of a body become solid within a step.

    Args:
        solid: whether they are solid at its start, shape (cells,).

    Attributes:
        least: least solid fraction of the cells until the end of the step, shape (cells,).
    """

    def __init__(self, solid: BoolArray) -> None:
        self.least: FloatArray = np.zeros(len(solid))
        self._births: IntArray = np.zeros(len(solid), dtype=np.int32)
        self._solid = solid

    def note(self, fraction: FloatArray, coherency: float) -> None:
        """Take note of the solid fractions of the cells in a pass, shape (cells,).

        Args:
            fraction: solid fractions, whatever the least ones are, shape (cells,).
            coherency: from which on a cell is solid.
        """
        solid = fraction >= coherency
        born = solid & ~self._solid
        self._births += born
        lasting = born & (self._births >= FIRST_LASTING)
        self.least[lasting] = np.maximum(self.least, fraction)[lasting]
        self._solid = solid
