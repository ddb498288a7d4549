"""Flatness and roundness of surfaces as measured: range about the surface of least squares."""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray


def flatness(points: FloatArray, areas: FloatArray | None = None) -> float:
    """Return the range of distances to the plane of least squares [m].

    Args:
        points: of a surface (n, 3), or of a line in a plane model (n, 2) [m].
        areas: weights of the points, (n,) [m²]; None: all count alike.
    """
    shares = np.ones(len(points)) if areas is None else areas
    away = points - np.average(points, axis=0, weights=shares)
    spread = (shares[:, None] * away).T @ away
    normal = np.linalg.eigh(spread)[1][:, 0]
    return float(np.ptp(away @ normal))


def roundness(points: FloatArray, areas: FloatArray | None = None) -> float:
    """Return the range of radii about the circle of least squares of the distances [m].

    Args:
        points: in the plane of the section, (n, 2) [m].
        areas: weights of the points, (n,) [m²]; None: all count alike.
    """
    from scipy.optimize import least_squares  # few runs need it, and it takes long to import

    shares = np.ones(len(points)) if areas is None else areas
    away = points - np.average(points, axis=0, weights=shares)
    size = float(np.abs(away).max())
    away, root = away / size, np.sqrt(shares / shares.mean())

    def miss(circle: FloatArray) -> FloatArray:
        return np.asarray(root * (np.linalg.norm(away - circle[:2], axis=1) - circle[2]))

    first = np.array([0.0, 0.0, float(np.linalg.norm(away, axis=1).mean())])
    found = least_squares(miss, first, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15).x
    return float(size * np.ptp(np.linalg.norm(away - found[:2], axis=1)))
