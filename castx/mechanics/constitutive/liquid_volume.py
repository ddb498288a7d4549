"""Volume of liquid: what a cell lacks is kept while solid is far, and forgotten as it comes.

Liquid is close to incompressible, θ = E, which elements that share their pressures hold as a mean
over neighbours; single cells are off. A cell keeps its E, and returns to it in the steps behind. If
θ were taken for E in each step, a shell at rest would move by as much in every step, however short,
so that its gaps would grow as steps shrink. Beside a front, that return would strain the skin
which has just been born in the cell next to it. There E comes to be θ before the front arrives,
with which solid is born (`growth`), and in the same way for any steps.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.mechanics.constitutive.growth import MetalNodes
from castx.mechanics.constitutive.integration_points import IntegrationPoints
from castx.mechanics.constitutive.law import Conditions

FORGETTING = 9.0
"""k. A slab that freezes in default steps, in triangles, is off by 9.5 % of the yield stress with
k = 0, by 1.9 to 2.2 % from 2 to 12; gaps that a skin leaves rise by 2 % from 3 to 9. Liquid keeps
errors of the solver too: gaps of mirrored castings in one mould differ by up to 0.9 % with 3, by
0.02 % with 9."""


def forgotten(
    points: IntegrationPoints,
    start: MetalNodes,
    conditions: Conditions,
    pooled: BoolArray | None = None,
) -> FloatArray:
    """Return the part of θ − E that the volumes forget in a step, shape (volumes,); collective.

    With W the share of solid around a cell of liquid, the mean over the cells at its corners,

        dE = k (θ − E) dW   while W grows.

    Args:
        points: of the body.
        start: metal of the nodes at the start of the step.
        conditions: of the law in the step.
        pooled: cells of which a pool holds the volume of all together, shape (cells,), which
            forget all of it; None: there are none.
    """
    corners = points.cell_nodes
    grown = np.maximum(conditions.nodes.share - start.share, 0.0)
    near = points.means_around_nodes(grown[corners].max(axis=1))[corners].max(axis=1)
    part = points.cells_to_volumes(np.minimum(FORGETTING * near, 1.0))
    part = np.where(conditions.coherent, 0.0, part)
    return part if pooled is None else np.where(points.cells_to_volumes(pooled), 1.0, part)
