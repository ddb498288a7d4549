"""Places at which solid is summed over a cell: its corners, and samples inside where mush ends.

The solid fraction stands at the nodes. An alloy's share w of what bears rises from 0 to 1 over a
few kelvins, which may lie within a cell: corners alone then pass from liquid to solid one after the
other, and a skin begins with half a cell. The temperature is linear in a cell, so that samples
inside know how far the solid has come. A sample belongs to the nearest integration point.

Where points have volumes of their own, those of a cell that holds the front have what its samples
have on the mean. By points its liquid would contract in place of the solid beside it: it bears no
shear, and the pressure, linear in the cells, weighs points against each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from castx.arrays import FloatArray, IntArray, LongArray
from castx.domain.cell_samples import SHARE_DEGREES, SampleRule, sample_rule
from castx.mechanics.constitutive.integration_points import IntegrationPoints

AS_NEAR = 1e-9
"""Difference of distances, in sizes of the cell, by which two points are equally near."""


class MetalPlaces:
    """The nodes of a body, and samples inside some of its cells.

    Values at the places are one array, of the nodes first, then of the samples cell by cell.

    Args:
        points: integration points of the body.
        cells: local cells with samples, shape (sampled cells,).
    """

    def __init__(self, points: IntegrationPoints, cells: IntArray) -> None:
        self._points, self._cells = points, cells
        self._nodes = len(points.node_numbering.numbers)
        self._at_samples: FloatArray = np.empty((0, 0))
        if len(cells):
            rule = sample_rule(points.kind, SHARE_DEGREES)
            self._at_samples, self._of_cell = rule.shapes, rule.shares
            self._of_points = _nearest(points.places, rule)
            self._fronts: LongArray = np.empty(0, dtype=np.int64)

    @property
    def sampled(self) -> bool:
        """Whether there are samples on this rank."""
        return len(self._cells) > 0

    def from_nodes(self, values: FloatArray) -> FloatArray:
        """Return nodal values at the places, linear in the cells, shape (places,)."""
        return self.joined(values, self.samples_from_nodes(values))

    def samples_from_nodes(self, values: FloatArray) -> FloatArray:
        """Return nodal values at the samples, linear in the cells, shape (samples,)."""
        if not self.sampled:
            return np.empty(0)
        corners = values[self._points.cell_nodes[self._cells]]
        return np.asarray(corners @ self._at_samples.T).ravel()

    def joined(self, nodes: FloatArray, samples: FloatArray) -> FloatArray:
        """Return values of nodes and samples as one array, shape (places,)."""
        return np.concatenate([nodes, samples]) if self.sampled else nodes

    def follow_fronts(self, shares: Sequence[FloatArray]) -> None:
        """Give points of cells that hold a front the means of their cell from now on.

        These are cells of which some sample has solid and some has none.

        Args:
            shares: w of the places at the start of a step and at its end, each (places,).
        """
        if self.sampled and self._points.volumes == self._points.count:
            samples = np.concatenate([self._samples(share) for share in shares], axis=1)
            holds = (samples > 0.0).any(axis=1) & (samples <= 0.0).any(axis=1)
            self._fronts = np.flatnonzero(holds)

    def volume_means(self, values: FloatArray) -> FloatArray:
        """Return means of values at the places over the volumes, shape (volumes,)."""
        if self._points.volumes == self._points.count:
            return self.at_points(values)
        found = self._points.volume_means(values[: self._nodes])
        if self.sampled:
            found[self._cells] = self._samples(values) @ self._of_cell
        return found

    def at_points(self, values: FloatArray) -> FloatArray:
        """Return values at the places as means round the points, shape (points,)."""
        found = self._points.from_nodes(values[: self._nodes])
        if self.sampled:
            samples = self._samples(values)
            here = samples @ self._of_points.T
            here[self._fronts] = (samples[self._fronts] @ self._of_cell)[:, None]
            self._points.by_cell(found)[self._cells] = here
        return found

    def integrals(self, values: Sequence[FloatArray]) -> FloatArray:
        """Return ∫ v over the body of arrays at the places, shape (arrays,); collective."""
        own = np.array([self._nodal_weights @ each[: self._nodes] for each in values])
        if self.sampled:
            here = self._cells < self._points.owned_cells
            weights = self._points.weights[self._cells[here]]
            for number, each in enumerate(values):
                own[number] += np.sum(weights * (self._samples(each)[here] @ self._of_points.T))
        return self._points.summed(own)

    @cached_property
    def _nodal_weights(self) -> FloatArray:
        """∫ N over the cells of this rank that have no samples, shape (nodes,).

        None is left of cells that have some, not even rounding: sums that vanish are divided.
        """
        counts = np.ones(self._points.count)
        if self.sampled:
            self._points.by_cell(counts)[self._cells] = 0.0
        return self._points.to_nodes(counts, self._nodes)

    def _samples(self, values: FloatArray) -> FloatArray:
        """Return values at the samples with one row for each cell that has some."""
        return values[self._nodes :].reshape(len(self._cells), -1)


def _nearest(points: FloatArray, rule: SampleRule) -> FloatArray:
    """Return the shares that samples have in the means round the points, (points, samples).

    Args:
        points: places of the points of a cell, shape (points, tdim).
        rule: the samples.
    """
    distances = np.linalg.norm(points[:, None] - rule.places, axis=2)
    near = distances <= distances.min(axis=0) + AS_NEAR
    parts = near * (rule.shares / near.sum(axis=0))
    return np.asarray(parts / parts.sum(axis=1, keepdims=True))
