"""Duration of freezing from one solid fraction to another, in the mean of a control volume.

Two levels may lie closer together than nodes do, and then the difference of their times of passing
at a node is worth little: the temperature of a node is too high by up to a tenth of what it differs
from its neighbours while its control volume passes the solidus, where the enthalpy has a kink, and
too low afterwards. Each level sees that at another time. But it goes to and fro as fronts pass
nodes, and its mean over all places between two nodes is small. So each place of a control volume
has the temperature between the nodes of its cell, and counts while that is in the range; what a
node has is the mean over its control volume. On V3 the error of the ratio of Clyne and Davies is
5, 2 and 0.5 % with 0.2, 0.4 and 0.7 elements between the fronts of 0.9 and 0.99.

What freezes at one temperature is told apart by its enthalpy, of which the temperature is given a
share too small to be seen elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.foundry.front.control_volumes import ControlVolumes
from castx.foundry.front.levels import FreezingCurve
from castx.foundry.front.windows import Window, enthalpy_at

PARTS = 4
"""Parts of a step in which temperatures are taken as linear; enthalpies are in the whole of it."""
TILT = 1e-6
"""Share of the enthalpy in the followed temperature, relative to that of the freezing range."""


class Lasting:
    """Durations of control volumes between solid fractions, followed step by step.

    Attributes:
        durations: so far, of each range, (ranges, nodes) [s].

    Args:
        volumes: control volumes of the body.
        curve: enthalpy of its material.
        fractions: the ends of the ranges, one range from each to the next one, rising.
    """

    def __init__(
        self, volumes: ControlVolumes, curve: FreezingCurve, fractions: Sequence[float]
    ) -> None:
        self._volumes, self._curve = volumes, curve
        enthalpies = np.array([enthalpy_at(curve, fraction) for fraction in fractions])
        hottest, *_, coldest = curve.temperature(enthalpies)
        self._tilt = TILT * max(float(hottest - coldest), 1.0) / float(np.ptp(enthalpies))
        ends = self._followed(enthalpies)
        self._windows = [Window(float(first), float(last)) for first, last in pairwise(ends)]
        self.durations: FloatArray
        self.begin()

    def begin(self) -> None:
        """Begin anew, as a body does that has just been poured."""
        self.durations = np.zeros((len(self._windows), self._volumes.nodes))

    def begin_amid(self, enthalpy: FloatArray) -> None:
        """Begin with metal whose way is not known: what is in a range has no duration; collective.

        Args:
            enthalpy: of the nodes, (nodes,) [J/m³].
        """
        self.begin()
        self.durations[:, self._begun(enthalpy)] = np.nan

    def follow(self, start: FloatArray, end: FloatArray, size: float) -> None:
        """Take over a step; a control volume that is above all ranges begins anew; collective.

        Args:
            start: enthalpies of the nodes at its start, (nodes,) [J/m³].
            end: at its end.
            size: of the step [s].
        """
        self.durations[:, ~self._begun(start)] = 0.0
        self.durations += size * self._shares(start, end)

    def ended(self, enthalpy: FloatArray) -> FloatArray:
        """Return the durations of control volumes that are beyond all ranges; collective.

        Args:
            enthalpy: of the nodes, (nodes,) [J/m³].

        Returns:
            (ranges, nodes) [s], not a number where it goes on.
        """
        left = self._some(self._followed(enthalpy), self._windows[-1].end, below=False)
        return np.where(left, np.nan, self.durations)

    def _begun(self, enthalpy: FloatArray) -> BoolArray:
        """Return the nodes whose control volumes are not all above the first range; collective."""
        return self._some(self._followed(enthalpy), self._windows[0].begin, below=True)

    def _shares(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Return the share of a step that control volumes spend in each range, (ranges, nodes)."""
        sums = np.zeros_like(self.durations)
        instants = [start + (end - start) * part / PARTS for part in range(PARTS + 1)]
        for before, after in pairwise(self._followed(enthalpy) for enthalpy in instants):
            cells = self._between(np.minimum(before, after), np.maximum(before, after))
            first, last = self._points(before, cells), self._points(after, cells)
            for place, window in enumerate(self._windows):
                sums[place] += self._volumes.shares(cells, window.share(first, last)) / PARTS
        return self._volumes.added(list(sums))

    def _followed(self, enthalpy: FloatArray) -> FloatArray:
        """Return a strictly monotonic temperature: a small part of the enthalpy is added [°C]."""
        return np.asarray(self._curve.temperature(enthalpy) + self._tilt * enthalpy)

    def _points(self, followed: FloatArray, parts: tuple[LongArray, LongArray]) -> FloatArray:
        """Return values between nodes at the points of parts, (parts, points)."""
        cells, corners = parts
        at_corners = followed[self._volumes.cell_nodes[cells]]
        return np.asarray(np.einsum("pqb,pb->pq", self._volumes.shapes[corners], at_corners))

    def _parts(self, cells: BoolArray) -> tuple[LongArray, LongArray]:
        """Return cell and corner of all parts of marked cells (cells,)."""
        found = np.nonzero(np.broadcast_to(cells[:, None], self._volumes.cell_nodes.shape))
        return found[0], found[1]

    def _between(self, low: FloatArray, high: FloatArray) -> tuple[LongArray, LongArray]:
        """Return the parts of cells some of which may be in a range, values of nodes (nodes,)."""
        cells = self._volumes.cell_nodes
        coldest, hottest = low[cells].min(axis=1), high[cells].max(axis=1)
        begin, end = self._windows[0].begin, self._windows[-1].end
        return self._parts((coldest <= begin) & (hottest >= end))

    def _some(self, followed: FloatArray, value: float, *, below: bool) -> BoolArray:
        """Return the nodes with a place in the control volume that is below, or above; collective.

        Args:
            followed: of the nodes, (nodes,) [°C].
            value: that divides below and above.
            below: whether below is asked for.
        """
        sign = 1.0 if below else -1.0
        rise = sign * (followed - value)
        at_corners = rise[self._volumes.cell_nodes]
        whole = self._parts(at_corners.max(axis=1) < 0.0)
        mixed = self._parts((at_corners.max(axis=1) >= 0.0) & (at_corners.min(axis=1) < 0.0))
        count = self._volumes.at_nodes(whole, np.ones(len(whole[0])))
        some = np.asarray((self._points(rise, mixed) < 0.0).any(axis=1), dtype=np.float64)
        count += self._volumes.at_nodes(mixed, some)
        return np.asarray(self._volumes.added([count])[0] > 0.0)
