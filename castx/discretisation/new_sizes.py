"""Sizes of the cells of a next mesh by the errors of the present one.

A cell with the squared error e², cut into (h/h')^d cells of size h', leaves each of them with

    e² (h'/h)^{2p + d},

p being the order of the error in h. A mesh of so many cells is best when all of them have the same
error, h' = h (c/e²)^{1/(2p + d)}: O. C. Zienkiewicz, J. Z. Zhu, International Journal for Numerical
Methods in Engineering 24 (1987) 337; E. Oñate, G. Bugeda, Engineering Computations 10 (1993) 307.
No cell becomes larger here, since a run has more wishes than one error.
"""

from __future__ import annotations

from math import factorial

import numpy as np
from scipy.optimize import brentq

from castx.arrays import FloatArray, LongArray
from castx.meshes.linear_mesh import handedness

ORDER = 1.0
"""p of stress and heat flux that are constant in the cells."""
SMALLEST = 1.0 / 3.0
"""Of a new size to the present one: errors of a coarse mesh say no more."""
CLOSE = 1e-3
"""Of ln c."""


class ErringMesh:
    """A mesh of simplices with the errors of its cells.

    Attributes:
        points: (points, dimension) [m].
        cells: points of each cell, (cells, dimension + 1).

    Args:
        points: (points, dimension) [m].
        cells: points of each cell, (cells, dimension + 1).
        squares: squared errors, (cells,).
        filling: volume of a cell over the power of its size.
        slope: by how much sizes grow over a distance at most, as a share of it.
    """

    def __init__(
        self,
        points: FloatArray,
        cells: LongArray,
        squares: FloatArray,
        filling: float,
        slope: float,
    ) -> None:
        self.points, self.cells = points, cells
        self._dimension = points.shape[1]
        self._power = 2.0 * ORDER + self._dimension
        self._volumes = simplex_volumes(points, cells)
        self._sizes = (self._volumes / filling) ** (1.0 / self._dimension)
        self._logs = np.log(np.maximum(squares, np.finfo(float).tiny))
        self._erring = squares > 0.0
        self._edges = _edges(cells)
        first, second = self._edges
        self._rise = slope * np.linalg.norm(points[first] - points[second], axis=1)
        self._around = np.bincount(cells.ravel(), minlength=len(points))

    def next_sizes(self, growth: float) -> FloatArray:
        """Return sizes at the points for a next mesh, (points,) [m].

        Args:
            growth: number of its cells over that of the present ones, more than 1; less where all
                that err become as small as may be.
        """
        present = self._at_points(self._sizes)
        if not self._erring.any():
            return present
        wanted = growth * self._count(present)

        def beyond(level: float) -> float:
            return self._count(self._with(level)) - wanted

        lowest = float(self._logs[self._erring].min()) + self._power * np.log(SMALLEST)
        if beyond(lowest) <= 0.0:
            return self._with(lowest)
        highest = float(self._logs.max())
        if beyond(highest) >= 0.0:  # sizes grow so gently that there are more already
            return self._with(highest)
        return self._with(float(brentq(beyond, lowest, highest, xtol=CLOSE)))

    def _with(self, level: float) -> FloatArray:
        """Return gently growing sizes at the points for ln c."""
        shrunk = np.exp((level - self._logs) / self._power)
        return self._gentle(self._at_points(self._sizes * np.clip(shrunk, SMALLEST, 1.0)))

    def _at_points(self, sizes: FloatArray) -> FloatArray:
        """Return geometric means over the cells of each point."""
        logs = np.repeat(np.log(sizes), self.cells.shape[1])
        sums = np.bincount(self.cells.ravel(), weights=logs, minlength=len(self.points))
        return np.asarray(np.exp(sums / np.maximum(self._around, 1)))

    def _gentle(self, sizes: FloatArray) -> FloatArray:
        """Return the largest sizes below these that nowhere grow faster than the slope."""
        first, second = self._edges
        while True:
            before = sizes.copy()
            np.minimum.at(sizes, first, before[second] + self._rise)
            np.minimum.at(sizes, second, before[first] + self._rise)
            if np.array_equal(before, sizes):
                return sizes

    def _count(self, sizes: FloatArray) -> float:
        """Return a number in proportion to that of the cells of these sizes."""
        return float(np.sum(self._volumes / sizes[self.cells].mean(axis=1) ** self._dimension))


def simplex_volumes(points: FloatArray, cells: LongArray) -> FloatArray:
    """Return the volumes of simplices, (cells,), those of triangles areas."""
    return np.asarray(np.abs(handedness(points, cells)) / factorial(points.shape[1]))


def _edges(cells: LongArray) -> tuple[LongArray, LongArray]:
    """Return the two points of each edge of simplices."""
    one, other = np.triu_indices(cells.shape[1], 1)
    pairs = np.sort(np.stack([cells[:, one], cells[:, other]], axis=-1).reshape(-1, 2), axis=1)
    first, second = np.unique(pairs, axis=0).T
    return first, second
