"""Bodies that touch each other and nothing else: their weight takes them along together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray

CONSTRAINED = 1e-8
"""Sum of squares above which constraint rows fix a motion that moves nodes by about one."""

WORK = 1e-9
"""Share of the weight whose work in a motion counts as none."""


@dataclass(frozen=True)
class BodiesTogether:
    """Bodies joined by contact, none of them rigid.

    Where no condition holds them against their weight f, Zᵀf ≠ 0 in a free motion Z of all of them
    as one, as a casting and its core once the mould is gone, there is nothing that they could fall
    onto. They are held where they are, by forces that are spread like their weight: so heavy ones
    do not press on light ones, nor fall away from them.

    Attributes:
        common: motions of all of them as one body, by those of each, shape (common, motions).
        weight: work of their weight in these [N], shape (common,).
        density: that of the body of each motion over their mean, else one, shape (motions,).
    """

    common: FloatArray
    weight: FloatArray
    density: FloatArray

    def falling(self, gram: FloatArray) -> FloatArray:
        """Return the free motions of all of them if their weight moves them, shape (free, motions).

        Args:
            gram: sums of products of what each motion does to constraints, (motions, motions).
        """
        values, vectors = np.linalg.eigh(self.common @ gram @ self.common.T)
        free = vectors[:, values < CONSTRAINED].T
        falls = np.linalg.norm(free @ self.weight) > WORK * np.linalg.norm(self.weight)
        return np.asarray(free @ self.common if falls else self.common[:0])


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
