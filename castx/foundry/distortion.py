"""Distortion against the nominal shape, and the mould surface that makes up for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray


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
    nominal: FloatArray, places: FloatArray, areas: FloatArray, axisymmetric: bool = False
) -> FloatArray:
    """Return by which share a shape has shrunk along the axes, 1 - U_ii, (gdim,).

    U is the stretch of the homogeneous deformation F = R U that comes nearest to where the shape
    has gone, F = Σ A (x - x̄)(X - X̄)ᵀ [Σ A (X - X̄)(X - X̄)ᵀ]⁻¹, least squares weighted by area: a
    part that bends or turns does not shrink by that.

    Args:
        nominal: X, (n, gdim) [m].
        places: x, of the same shape [m].
        areas: weights, (n,) [m²].
        axisymmetric: the first coordinate is a radius, whose stretch is that of all radii.
    """
    weights = areas / areas.sum()
    middle, moved = weights @ nominal, weights @ places
    if axisymmetric:
        middle[0] = moved[0] = 0.0
    before, after = nominal - middle, places - moved
    if axisymmetric:
        return np.asarray(1.0 - (weights @ (after * before)) / (weights @ before**2))
    weighted = weights[:, None] * before
    gradient = (after.T @ weighted) @ np.linalg.pinv(before.T @ weighted)
    _, sizes, right = np.linalg.svd(gradient)
    return np.asarray(1.0 - np.diag(right.T * sizes @ right))


def compensated(mould: FloatArray, cast: FloatArray, nominal: FloatArray) -> FloatArray:
    """Return the next mould surface, X ← X - (x(X) - X_nominal) [m].

    Args:
        mould: X, surface of the mould (n, gdim) [m].
        cast: x(X), where the surface that it casts ends, of the same shape [m].
        nominal: where it should end [m].
    """
    return np.asarray(mould - (cast - nominal))
