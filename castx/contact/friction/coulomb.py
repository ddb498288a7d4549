"""Coulomb friction of node pairs: rows and directions, for both its forms.

A closed pair sticks as long as |t| ≤ μ p, t the traction along the surface; one that slips bears
t = μ p against its motion since the last accepted step (P. Wriggers, Computational Contact
Mechanics, 2nd ed. 2006, chapter 5).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray
from castx.contact.kinematics.gaps import Gaps


def unit(vectors: FloatArray, otherwise: FloatArray) -> FloatArray:
    """Return vectors over their lengths, and others where they vanish, shape (n, dimension)."""
    size = np.linalg.norm(vectors, axis=1, keepdims=True)
    directions = otherwise.copy()
    np.divide(vectors, size, out=directions, where=size > 0)
    return directions


def shortened(vectors: FloatArray, lengths: FloatArray) -> FloatArray:
    """Return vectors over the larger of their own and given lengths, zero where both vanish.

    Args:
        vectors: shape (n, dimension).
        lengths: shape (n,).
    """
    size = np.maximum(np.linalg.norm(vectors, axis=1), lengths)[:, None]
    return np.asarray(np.divide(vectors, size, out=np.zeros_like(vectors), where=size > 0))


def forward(vectors: FloatArray, before: FloatArray) -> FloatArray:
    """Return vectors over their lengths, former ones where they vanish or have turned back."""
    found = unit(vectors, before)
    back = np.sum(found * before, axis=1, keepdims=True) < 0.0
    return np.where(back, before, found)


class SlidingRows:
    """The directions along the surface of the rows that have friction, ‖t‖ ≤ μ p.

    Attributes:
        rows: numbers of these rows among all, shape (n,).
        coefficient: μ, shape (n,).
        tangents: orthonormal, zero where a motion is not free, shape (n, dimension - 1, dimension).
        local: local numbers of the motions in v, -1 where they are no unknowns, shape
            (n, dimension - 1).

    Args:
        gaps: the pairs of all interfaces.
        coefficients: μ of each interface.
    """

    def __init__(self, gaps: Gaps, coefficients: Sequence[float]) -> None:
        self._gaps = gaps
        count = len(gaps.local)
        wanted = np.zeros(count)
        for part, coefficient in zip(gaps.slices, coefficients, strict=True):
            wanted[part] = coefficient
        self.rows = np.flatnonzero((wanted > 0) & gaps.free)
        self.coefficient = wanted[self.rows]
        self.tangents = _of_all(gaps, "tangents")[self.rows]
        self.local = _of_all(gaps, "tangent_local")[self.rows]

    def primary_motion(self) -> FloatArray:
        """Return the motion of rigid primary bodies along the tangents [m]."""
        motion = self._gaps.primary_motion[self.rows]
        return np.asarray(np.einsum("nkd,nd->nk", self.tangents, motion))

    def vectors(self, tractions: FloatArray) -> FloatArray:
        """Return forces along the tangents (n, dimension - 1) as vectors of all rows [N]."""
        found = np.zeros((len(self._gaps.local), self.tangents.shape[2]))
        found[self.rows] = np.einsum("nk,nkd->nd", tractions, self.tangents)
        return found


def _of_all(gaps: Gaps, name: str) -> npt.NDArray[Any]:
    """Return an array of all rows; tied ones have no tangents and get zeros or -1."""
    parts = []
    width = max(getattr(i, name).shape[1] for i in gaps.interfaces)
    for interface in gaps.interfaces:
        values = getattr(interface, name)
        shape = (len(values), width, *values.shape[2:])
        filled = np.full(shape, -1 if name == "tangent_local" else 0, dtype=values.dtype)
        filled[:, : values.shape[1]] = values
        parts.append(filled)
    return np.concatenate(parts)
