"""Bodies that nothing holds against their weight, and that have nothing to fall onto."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import connected_components

from castx.arrays import BoolArray, FloatArray, IntArray

CONSTRAINED = 1e-8
"""Sum of squares above which constraint rows fix a motion that moves nodes by about one."""

WORK = 1e-9
"""Share of the weight whose work in a motion counts as none."""

STEEP = 1e-3
"""Part of a fall by which it closes a gap that does not end it: that of a wall which is upright."""


class FreeFall(NamedTuple):
    """How some bodies fall as one.

    Attributes:
        motions: free motions of all of them as one body, by those of each, shape (free, motions).
        path: the one in which their weight moves them, by about one, shape (motions,).
    """

    motions: FloatArray
    path: FloatArray


@dataclass(frozen=True)
class BodiesTogether:
    """Bodies joined by contact.

    Those of them fall as one which no constraint holds against their weight f, Zᵀf ≠ 0 in a free
    motion Z of all of them, and in whose fall no gap to another body closes: a casting and its core
    once the mould is gone, a casting round a core that stands if it does not stick to it, or a
    chill that a casting has let go. There is nothing that they could fall onto. They are held where
    they are, by forces that are spread like their weight: so heavy ones do not press on light ones,
    nor fall away from them.

    Attributes:
        body: number in the group of the body of each motion, -1 for other bodies, shape (motions,).
        common: motions of all as one body, by those of each, shape (common, motions).
        weight: work of the weight of each body in these [N], shape (bodies, common).
        volume: of each body as the model counts it [m³], shape (bodies,).
        density: weight of each body over its volume [N/m³], shape (bodies,).
        gaps: change of all gaps in each motion, shape (pairs, motions).
    """

    body: IntArray
    common: FloatArray
    weight: FloatArray
    volume: FloatArray
    density: FloatArray
    gaps: FloatArray

    def falling(self, gram: FloatArray) -> list[tuple[FloatArray, FloatArray]]:
        """Return the free motions of bodies that fall as one, and by how much each weighs more.

        Args:
            gram: sums of products of what each motion does to constraints, (motions, motions).

        Returns:
            For each such set of bodies: shape (free, motions); density of the body of each motion
            over the mean of the set, one for others, shape (motions,).
        """
        parts = [(part, fall) for part in self._parts(gram) if (fall := self._fall(part, gram))]
        while parts:
            together = [b for part, _ in parts for b in part]
            fall = self._fall(together, gram)
            if fall is None:  # they slide in different directions
                return [self._found(p, own) for p, own in parts if not self._hits(own)[p].any()]
            hits = self._hits(fall)
            if not hits.any():
                return [self._found(together, fall)]
            parts = [(part, own) for part, own in parts if not hits[part].any()]
        return []

    def _parts(self, gram: FloatArray) -> list[list[int]]:
        """Return the bodies, those together that constraints join."""
        own = [self.body == b for b in range(len(self.volume))]
        joined = [[np.abs(gram[np.ix_(a, b)]).max() > CONSTRAINED for b in own] for a in own]
        _, label = connected_components(np.array(joined), directed=False)
        return [[int(b) for b in np.flatnonzero(label == k)] for k in np.unique(label)]

    def _fall(self, bodies: Sequence[int], gram: FloatArray) -> FreeFall | None:
        """Return the free fall of bodies as one, with nothing in its way; None: they are held."""
        common = np.where(np.isin(self.body, bodies), self.common, 0.0)
        values, vectors = np.linalg.eigh(common @ gram @ common.T)
        free = vectors[:, values < CONSTRAINED].T
        weight = self.weight[bodies].sum(axis=0)
        work = free @ weight
        size = float(np.linalg.norm(work))
        if size <= WORK * np.linalg.norm(weight) or not self.density[bodies].all():
            return None
        motions = free @ common
        return FreeFall(motions, work @ motions / size)

    def _hits(self, fall: FreeFall) -> BoolArray:
        """Return the bodies with a gap that closes in a fall, shape (bodies,)."""
        closing = self.gaps @ fall.path < -STEEP
        moved = (self.gaps[closing] != 0.0).any(axis=0)
        return np.array([moved[self.body == b].any() for b in range(len(self.volume))])

    def _found(self, bodies: Sequence[int], fall: FreeFall) -> tuple[FloatArray, FloatArray]:
        mean = np.average(self.density[bodies], weights=self.volume[bodies])
        density = np.ones(len(self.body))
        for b in bodies:
            density[self.body == b] = self.density[b] / mean
        return fall.motions, density


def completed(first: FloatArray, free: FloatArray) -> FloatArray:
    """Return some motions, orthonormal, and as many further ones as span the space of others.

    Args:
        first: independent motions in that space, shape (first, motions).
        free: an orthonormal basis of it, shape (free, motions).
    """
    if len(first) == 0:
        return free
    basis = np.linalg.qr(first.T)[0].T
    rest = free - free @ basis.T @ basis
    further = np.linalg.svd(rest, full_matrices=False)[2]
    return np.concatenate([basis, further[: len(free) - len(first)]])
