"""Permeability of cells for the flow of a whole step.

Melt that freezing draws flows the faster the more of it there is, so that the mean over a cell and
a step is the one of a flow that grows with the liquid fraction g,

    1/K_mean = ⟨g/K⟩/⟨g⟩,

with g even in time, and in space between the smallest and the largest value of a cell: the flow
goes along the gradient of g. Pressures of even freezing along a line are so exact at the nodes of
any mesh; the pressure is then the mean over the step. K at the end of a step would choke a node
that freezes within it, K at its start would let everything through.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.mush_column import MushResistance
from castx.foundry.porosity import KOZENY_CARMAN

INSTANTS = 12
"""Points of Gauss's rule in time: g/K grows with 1/g² as a cell freezes."""


def step_permeability(
    resistance: MushResistance, start: FloatArray, end: FloatArray
) -> FloatArray:
    """Return K_mean of cells over a step [m²], zero in cells that have a solid corner at its start.

    Args:
        resistance: of the mush, with its floors of liquid and of solid fraction.
        start: liquid fraction at the corners at the start, shape (cells, corners).
        end: at the end.
    """
    flows = start.min(axis=1) > 0.0
    first, last = start[flows, None, :], end[flows, None, :]
    points, weights = np.polynomial.legendre.leggauss(INSTANTS)
    instants = 0.5 * (points + 1.0)[:, None]
    liquid = first + instants * (last - first)
    drag = resistance.drag(liquid.min(axis=-1), liquid.max(axis=-1)) @ weights
    middle = 0.5 * (liquid.min(axis=-1) + liquid.max(axis=-1)) @ weights
    found = np.zeros(len(start))
    found[flows] = resistance.arm_spacing**2 / KOZENY_CARMAN * middle / drag
    return found
