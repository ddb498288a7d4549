"""The outline of a section of CAD faces by triangles: what is nearest to a place, and its core."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray

AS_DEEP = 0.98
"""Share of the largest depth at which the middle of a section is taken for its core."""


@dataclass(frozen=True)
class Outline:
    """The outline of a flat section.

    Attributes:
        triangles: of the section, (triangles, 3 corners, 3) [m].
        segments: straight parts of the outline, (segments, 2, 3) [m].
    """

    triangles: FloatArray
    segments: FloatArray

    @classmethod
    def of(cls, triangles: FloatArray) -> Outline:
        """Return the outline of triangles, whose edges stand in two of them but for the outline."""
        edges = np.concatenate([triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
        ends = edges.round(9)
        swapped = [tuple(a) > tuple(b) for a, b in ends]
        ends[swapped] = ends[swapped][:, ::-1]
        _, first, count = np.unique(
            ends.reshape(-1, 6), axis=0, return_index=True, return_counts=True
        )
        return cls(triangles, edges[first[count == 1]])

    def nearest(self, place: FloatArray) -> FloatArray:
        """Return the point of the outline that is nearest to a place [m]."""
        start, along = self.segments[:, 0], self.segments[:, 1] - self.segments[:, 0]
        share = np.sum((place - start) * along, axis=1) / np.sum(along**2, axis=1)
        feet = start + np.clip(share, 0.0, 1.0)[:, None] * along
        return np.asarray(feet[np.linalg.norm(feet - place, axis=1).argmin()])

    def core(self, middle: FloatArray) -> FloatArray:
        """Return the place farthest from the outline [m]: the middle, or that of a triangle.

        Args:
            middle: of the section, which may lie outside of it [m].
        """
        inside = self.triangles.mean(axis=1)
        depths = np.array([self._depth(place) for place in inside])
        holds = any(_holds(triangle, middle) for triangle in self.triangles)
        if holds and self._depth(middle) >= AS_DEEP * depths.max():
            return middle
        return np.asarray(inside[depths.argmax()])

    def _depth(self, place: FloatArray) -> float:
        return float(np.linalg.norm(self.nearest(place) - place))


def _holds(triangle: FloatArray, place: FloatArray) -> bool:
    """Return whether a triangle contains a place of its plane."""
    edges = (triangle[1:] - triangle[0]).T
    shares = np.linalg.lstsq(edges, place - triangle[0], rcond=None)[0]
    return bool((shares > -1e-9).all() and shares.sum() < 1.0 + 1e-9)
