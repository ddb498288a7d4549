"""Spacing of the secondary arms while they coarsen."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.mechanics.mush.metal import MushMetal
from castx.stateful import Arrays, Numbering, Saved

LEAST_COOLING = 1.0
"""Cooling below the liquidus [K] over which a rate is taken at least. What a node does in its first
moments there, just as slow as steps are short, says nothing of its arms, and they would keep it."""

Nodes = tuple[FloatArray, FloatArray, FloatArray]
"""Temperature [°C], time since the liquidus [s] and spacing [m] of the nodes, each (nodes,)."""


class RunningArms:
    """Arm spacing λ2 = C_λ ((t − t_L)/(T_L − T))^n of the nodes, t_L the passing of the liquidus.

    The rate is the mean one since the liquidus, in the first step its own, with T_L − T no less
    than `LEAST_COOLING`, and the slowest one in a step, in which the temperature is linear. Arms
    never grow finer, and what melts again loses them.

    Args:
        metal: of the body.
        corners: nodes of each cell, shape (cells, corners).
        numbering: of the nodes.
    """

    def __init__(self, metal: MushMetal, corners: IntArray, numbering: Numbering) -> None:
        self._metal, self._corners, self._numbering = metal, corners, numbering
        none: FloatArray = np.zeros(len(numbering.numbers))
        self._state: Nodes = (np.full_like(none, np.inf), none, none)
        self._trial: Nodes = self._state

    def begin(self, temperature: FloatArray, solid: FloatArray, step: float) -> FloatArray:
        """Return the spacing in the cells in a trial step [m], shape (cells,).

        Args:
            temperature: of the nodes at its end [°C], shape (nodes,).
            solid: their solid fractions then, likewise.
            step: its size [s].
        """
        metal = self._metal
        if metal.exponent == 0.0:
            return np.full(len(self._corners), metal.spacing)
        before, elapsed, spacing = self._state
        before = np.where(np.isinf(before), temperature, before)
        below, cooled = metal.liquidus - temperature, before - temperature
        mushy, cools = below > 0.0, cooled > 0.0
        inside = step * self._share_below(before, temperature, solid)
        since = np.where(mushy, elapsed + inside, 0.0)
        ratio = since / np.maximum(below, LEAST_COOLING)
        # Largest where the node passes the least cooling: a step that passes it by would miss it.
        passes = cools & (below > LEAST_COOLING) & (below - cooled < LEAST_COOLING)
        lower = np.minimum(below, cooled)
        beyond = np.divide(below - LEAST_COOLING, lower, out=np.zeros_like(below), where=passes)
        at_least = (since - inside * beyond) / LEAST_COOLING
        ratio = np.where(passes, np.maximum(ratio, at_least), ratio)
        spacing = np.where(mushy, np.maximum(spacing, metal.spacing * ratio**metal.exponent), 0.0)
        self._trial = temperature.copy(), since, spacing
        known = spacing[self._corners]
        count = (known > 0.0).sum(axis=1)
        return np.asarray(
            np.divide(known.sum(axis=1), count, out=np.full(len(count), metal.spacing),
                      where=count > 0)
        )  # fmt: skip

    def _share_below(
        self, before: FloatArray, temperature: FloatArray, solid: FloatArray
    ) -> FloatArray:
        """Return the share of a step in which nodes are below the liquidus, shape (nodes,).

        Heat goes evenly: melt cools fast to its liquidus, and slowly below. A node that is mushy
        from the start of a run, whose liquidus nobody has seen, has been so for as long as its
        present rate takes.

        Args:
            before: temperature at the start [°C], shape (nodes,).
            temperature: at the end, likewise.
            solid: f at the end, likewise.
        """
        metal = self._metal
        below, above = metal.liquidus - temperature, before - metal.liquidus
        unseen, cooled = (self._state[1] <= 0.0) & (above <= 0.0), before - temperature
        heat = np.maximum(below, 0.0) + metal.latent * solid
        whole = heat + np.maximum(above, 0.0)
        share = np.divide(heat, whole, out=np.ones_like(heat), where=above > 0.0)
        age = np.divide(below, cooled, out=np.zeros_like(heat), where=cooled > 0.0)
        return np.where(unseen, age, share)

    def commit(self) -> None:
        """Accept the trial state as the start of the next step."""
        self._state = self._trial

    def rewind(self) -> None:
        """Return to the start of the step."""
        self._trial = self._state

    def saved(self) -> dict[str, Saved]:
        """Return temperature, time since the liquidus and spacing of the nodes."""
        names = ("temperature", "elapsed", "spacing")
        return {
            name: Saved(values, self._numbering)
            for name, values in zip(names, self._state, strict=True)
        }

    def restore(self, arrays: Arrays) -> None:
        """Take them back."""
        self._state = (
            arrays["temperature"].copy(), arrays["elapsed"].copy(), arrays["spacing"].copy()
        )  # fmt: skip
        self._trial = self._state
