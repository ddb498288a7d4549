"""What feeders have supplied to the mechanics, and have still to take out of their pools.

The mechanics says what volume of liquid each feeder gives (`castx.mechanics.mush.levels`). What has
flowed out of a casting freezes there all the same and lacks β, which is no melt that is missing in
truth, and is taken off. What a feeder takes back is taken off what it gives next, and what the
pools did not have is asked for again.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.stateful import Arrays

TINY = float(np.finfo(np.float64).tiny)


class SuppliedMelt:
    """Volumes that the feeders of one body have given, and that its pools have still to lose.

    Args:
        feeders: their names.

    Attributes:
        owed: volumes that have not flowed out of a pool yet [m³], shape (feeders,).
    """

    def __init__(self, feeders: Sequence[str]) -> None:
        self._feeders = tuple(feeders)
        self.owed: FloatArray = np.zeros(len(self._feeders))
        self._supplied: FloatArray = np.zeros(len(self._feeders))
        self._asked: FloatArray = np.zeros((0, len(self._feeders)))

    def take_over(self, supplied: Mapping[str, float], empty: FloatArray) -> None:
        """Take over the volumes that feeders have given in a step.

        Args:
            supplied: what they have given since the start, by name [m³].
            empty: what metal that has flowed out of their pools lacks in the step [m³], (feeders,).
        """
        volumes = np.array([supplied[name] for name in self._feeders])
        step = volumes - self._supplied
        self.owed = self.owed + step - np.clip(empty, 0.0, np.maximum(step, 0.0))
        self._supplied = volumes

    def ask(self, open_to: BoolArray, freezing: FloatArray, liquid: FloatArray) -> FloatArray:
        """Return the volume that each pool has to lose [m³], shape (pools,).

        A feeder takes from the pools that are open to it in parts by what freezes in them, by their
        liquid if nothing does.

        Args:
            open_to: whether each pool is open to each feeder, (pools, feeders).
            freezing: volume that freezes in each pool in the step, (pools,) [m³].
            liquid: volume in each, (pools,) [m³].
        """
        weights = open_to * np.maximum(freezing, 0.0)[:, None]
        by_liquid = open_to * liquid[:, None]
        weights = np.where(weights.sum(axis=0) > 0.0, weights, by_liquid)
        shares = weights / np.maximum(weights.sum(axis=0), TINY)
        self._asked = shares * np.maximum(self.owed, 0.0)
        return np.asarray(self._asked.sum(axis=1))

    def pay(self, pool: int, volume: float) -> None:
        """Book a volume that has flowed out of a pool [m³] for the feeders that asked for it."""
        asked = self._asked[pool]
        self.owed = self.owed - asked * volume / max(asked.sum(), TINY)

    def saved(self) -> dict[str, FloatArray]:
        """Return the volumes, equal on all ranks."""
        return {"supplied": self._supplied, "owed": self.owed}

    def restore(self, arrays: Arrays) -> None:
        """Take them back."""
        self._supplied, self.owed = (np.array(arrays[name]) for name in ("supplied", "owed"))
