"""Covariance of parameters that are fitted to samples with noise.

Source: A. Tarantola, Inverse Problem Theory (2005), section 3.2: of a linear model with Gaussian
noise and prior it is exact, of another one that of its tangent.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray

BAND = 1.96
"""Half the width of a band of 95 % in deviations."""


def weighted(sensitivity: FloatArray, noise: FloatArray) -> FloatArray:
    """Return W^½ J with W = diag(1/σ²), (samples, parameters)."""
    return np.asarray(sensitivity / np.broadcast_to(noise, len(sensitivity))[:, None])


def posterior(
    sensitivity: FloatArray,
    noise: FloatArray,
    prior: FloatArray | None = None,
    smoothness: FloatArray | None = None,
) -> FloatArray:
    """Return C = (Jᵀ W J + Γ⁻¹ + Sᵀ S/γ²)⁻¹ with W = diag(1/σ²), (parameters, parameters).

    Args:
        sensitivity: J, change of each sample by each parameter, (samples, parameters).
        noise: σ of the samples, one number or (samples,).
        prior: Γ, covariance of what is known before; None: nothing is.
        smoothness: S/γ, (rows, parameters), as of `smoothness.second_differences`; None: a curve
            may be rough.

    Raises:
        ValueError: the samples do not tell all parameters apart, and no prior does.
    """
    scaled = weighted(sensitivity, noise)
    information = scaled.T @ scaled
    if prior is not None:
        information = information + np.linalg.inv(prior)
    if smoothness is not None:
        information = information + smoothness.T @ smoothness
    if np.linalg.matrix_rank(information) < len(information):
        raise ValueError("the samples do not tell all parameters apart: measure more, or give Γ")
    return np.asarray(np.linalg.inv(information))


def deviations(covariance: FloatArray) -> FloatArray:
    """Return the standard deviations of the parameters, (parameters,)."""
    return np.asarray(np.sqrt(np.diag(covariance)))


def correlation(covariance: FloatArray) -> FloatArray:
    """Return C_ij/√(C_ii C_jj), (parameters, parameters)."""
    scale = deviations(covariance)
    return np.asarray(covariance / np.outer(scale, scale))


def reduced_chi_square(
    residuals: FloatArray, noise: FloatArray, sensitivity: FloatArray, covariance: FloatArray
) -> float:
    """Return χ²_r = Σ r²/σ²/(n - tr[C Jᵀ W J]), near 1 if noise is all that the model lacks.

    The trace is the number of parameters that the samples, not what is known before, tell.

    Args:
        residuals: r, of the samples, (samples,).
        noise: σ of the samples, one number or (samples,).
        sensitivity: J, (samples, parameters).
        covariance: C of `posterior`.

    Raises:
        ValueError: there are not more samples than parameters that they tell.
    """
    scaled = weighted(sensitivity, noise)
    freedom = len(residuals) - float(np.trace(covariance @ scaled.T @ scaled))
    if freedom < 1e-9 * len(residuals):
        raise ValueError("there are not more samples than parameters: nothing is left to judge by")
    return float(np.sum((residuals / noise) ** 2) / freedom)


def widened(covariance: FloatArray, chi_square: float) -> FloatArray:
    """Return C max(1, χ²_r): a misfit above the noise widens, a lucky fit does not narrow."""
    return covariance * max(1.0, chi_square)


def band(changes: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the half width of the 95 % band of a curve, 1.96 √diag(J C Jᵀ), (points,).

    Args:
        changes: J, of the points of the curve by each parameter, (points, parameters).
        covariance: C.
    """
    return np.asarray(BAND * np.sqrt(np.einsum("ij,jk,ik->i", changes, covariance, changes)))
