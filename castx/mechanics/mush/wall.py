"""Melt of a mush at a wall: how far it holds there what is drawn away from it.

With **n** the normal of the wall, s the stress of the skeleton and p that of the melt, positive in
tension, the balance of a surface element is

    −p_c = **n**·s·**n** + p,   N = −**n**·s·**n** ≥ 0.

The wall presses on the grains by N, and cannot draw them: where they part from it melt comes in
between. So it draws by what the melt transmits and by no more, −p_c ≤ p, and the melt bears p up to
Δp_c, the depression at which a void opens (`castx.mechanics.mush.pores`). A void at the wall is a
gap. So the pull of a pair is bounded by

    −p_c ≤ Δp_c where f < 1 and p < Δp_c,   −p_c ≤ 0 elsewhere,

with f the solid fraction of its node and p the pressure at the start of the step. The share of the
metal that bears stress, and so coherency, has no part in it.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray
from castx.mechanics.mush.content import MeltContent
from castx.mechanics.mush.metal import MushMetal
from castx.mechanics.mush.pores import PoreSet

LAST_MELT = 1.0 / 3.0
"""Power of g/g_c by which the last melt counts. A wall lets go at the end of the step in which its
melt is gone, by as much too early or too late as this step is long: a tenth of the cube root of g
leaves a thousandth of the time for it, a tenth of g itself a tenth."""


class WallMelt:
    """Melt at the surface nodes of a body, as its contact sees it.

    Args:
        content: of the body.
        pores: of the body.
        metal: its melt.
    """

    def __init__(self, content: MeltContent, pores: PoreSet, metal: MushMetal) -> None:
        self._content, self._pores = content, pores
        self._cavitation, self._cut_off = metal.cavitation, 1.0 - metal.coalescence

    def pulls(self) -> FloatArray:
        """Return the largest pulls of walls in the trial step [Pa], shape (owned,)."""
        content = self._content
        holds = (content.solid[: content.owned] < 1.0) & ~self._pores.open_at_start
        return np.where(holds, self._cavitation, 0.0)

    def lost(self) -> FloatArray:
        """Return the change of min(1, g/g_c)^(1/3) in the trial step, shape (owned,).

        It is how fast the melt goes of which nothing is left when a wall is let go, see
        `LAST_MELT`.
        """
        content, own = self._content, slice(self._content.owned)
        states = content.start.solid[own], content.solid[own]
        before, after = (
            np.clip((1.0 - solid) / self._cut_off, 0.0, 1.0) ** LAST_MELT for solid in states
        )
        return np.asarray(np.abs(after - before))
