"""Distortion against the nominal shape, and the mould surface that makes up for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray

ROUNDING = 1e-10
"""Eigenvalue over the largest that counts as zero: of turns that a shape does not tell."""
APART = 0.25
"""Distance of two faces across an axis, over the extent along it, from which they tell a stretch:
nearer ones tell the thickness of a flange, and walls with a draught nothing."""


@dataclass(frozen=True, eq=False)
class RigidMotion:
    """Rotation about the origin, then translation: R x + t.

    Attributes:
        rotation: R, (gdim, gdim).
        translation: t, (gdim,) [m].
    """

    rotation: FloatArray
    translation: FloatArray

    def removed(self, places: FloatArray) -> FloatArray:
        """Return places (n, gdim) [m] moved back."""
        return np.asarray((places - self.translation) @ self.rotation)


def best_fit(
    nominal: FloatArray, places: FloatArray, areas: FloatArray, axisymmetric: bool = False
) -> RigidMotion:
    """Return the rigid motion of the nominal shape that comes nearest to where it has gone.

    Least squares weighted by area, by the singular values of Σ A (x - x̄)(X - X̄)ᵀ: W. Kabsch, Acta
    Cryst. A 32 (1976) 922. A reflection is never taken.

    Args:
        nominal: X, (n, gdim) [m].
        places: x = X + u, of the same shape [m].
        areas: weights, (n,) [m²].
        axisymmetric: the first coordinate is a radius: only the axis is left to move along.
    """
    shares = areas / areas.sum()
    middle, moved = shares @ nominal, shares @ places
    if axisymmetric:
        return RigidMotion(np.eye(2), np.array([0.0, (moved - middle)[1]]))
    covariance = (shares[:, None] * (places - moved)).T @ (nominal - middle)
    left, _, right = np.linalg.svd(covariance)
    turn = np.eye(len(left))
    turn[-1, -1] = np.sign(np.linalg.det(left @ right))
    rotation = left @ turn @ right
    return RigidMotion(rotation, moved - rotation @ middle)


def normal_deviation(nominal: FloatArray, fitted: FloatArray, normals: FloatArray) -> FloatArray:
    """Return (x - X)·n, the deviation along the nominal outward normal, positive outward [m].

    Args:
        nominal: X, (n, gdim) [m].
        fitted: x without the rigid motion, of the same shape [m].
        normals: n of length 1, of the same shape.
    """
    return np.asarray(np.einsum("ij,ij->i", fitted - nominal, normals))


def allowance(
    nominal: FloatArray,
    fitted: FloatArray,
    normals: FloatArray,
    areas: FloatArray,
    axisymmetric: bool = False,
) -> FloatArray:
    """Return by which share a shape has shrunk along the axes, 1 - U_ii, (gdim,).

    U is the stretch of F = R U, of the homogeneous deformation that comes nearest to where the
    shape has gone along its normals, min Σ A (n·(x − F X − t))²: a part that bends or turns does
    not shrink by that, nor does metal that slid along a wall as it was liquid. Not a number along
    an axis across which no faces lie apart, as towards an open top that is left out.

    Args:
        nominal: X, (n, gdim) [m].
        fitted: x without the rigid motion, of the same shape [m].
        normals: n of length 1, of the same shape.
        areas: weights A, (n,) [m²].
        axisymmetric: the first coordinate is a radius, whose stretch is that of all radii.
    """
    weights, axes = areas / areas.sum(), range(nominal.shape[1])
    moves = np.ones(len(axes))
    if axisymmetric:
        moves[0] = 0.0
    before = nominal - moves * (weights @ nominal)
    extents = np.where(moves > 0.0, 0.5 * np.ptp(before, axis=0), np.abs(before).max(axis=0))
    pairs = [(i, j) for i in axes for j in axes if i == j or not axisymmetric]
    stretches = [normals[:, i] * before[:, j] / extents[j] for i, j in pairs]
    rows = np.column_stack([*stretches, normals * moves])
    squares = rows.T @ (weights[:, None] * rows)
    right = rows.T @ (weights * normal_deviation(nominal, fitted, normals))
    found = np.linalg.pinv(squares, rcond=ROUNDING, hermitian=True) @ right
    gradient = np.eye(len(axes))
    for (i, j), value in zip(pairs, found[: len(pairs)], strict=True):
        gradient[i, j] += value / extents[j]
    # Two equal faces that are d apart have the variance (d/2)² along the axis.
    least = APART**2 * (weights @ normals**2)
    scatter = np.array([_left(squares, pairs.index((i, i))) for i in axes])
    return np.where(scatter > least, 1.0 - _stretch(gradient), np.nan)


def _stretch(gradient: FloatArray) -> FloatArray:
    """Return U_ii of a deformation gradient F = R U."""
    _, sizes, right = np.linalg.svd(gradient)
    return np.asarray(np.diag(right.T * sizes @ right))


def _left(squares: FloatArray, column: int) -> float:
    """Return the square of what is left of a column of rows beside all others, of RᵀR."""
    others = np.delete(squares[column], column)
    rest = np.delete(np.delete(squares, column, axis=0), column, axis=1)
    inverse = np.linalg.pinv(rest, rcond=ROUNDING, hermitian=True)
    return float(squares[column, column] - others @ inverse @ others)


def compensated(mould: FloatArray, cast: FloatArray, nominal: FloatArray) -> FloatArray:
    """Return the next mould surface, X ← X - (x(X) - X_nominal) [m].

    Args:
        mould: X, surface of the mould (n, gdim) [m].
        cast: x(X), where the surface that it casts ends, of the same shape [m].
        nominal: where it should end [m].
    """
    return np.asarray(mould - (cast - nominal))
