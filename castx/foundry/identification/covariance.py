"""Covariance of parameters that are fitted to samples with noise.

Source: A. Tarantola, Inverse Problem Theory (2005), section 3.2: of a linear model with Gaussian
noise and prior it is exact, of another one that of its tangent.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray


def posterior(
    sensitivity: FloatArray, noise: FloatArray, prior: FloatArray | None = None
) -> FloatArray:
    """Return C = (Jᵀ W J + Γ⁻¹)⁻¹ with W = diag(1/σ²), (parameters, parameters).

    Args:
        sensitivity: J, change of each sample by each parameter, (samples, parameters).
        noise: σ of the samples, one number or (samples,).
        prior: Γ, covariance of what is known before; None: nothing is.

    Raises:
        ValueError: the samples do not tell all parameters apart, and no prior does.
    """
    scaled = sensitivity / np.broadcast_to(noise, len(sensitivity))[:, None]
    information = scaled.T @ scaled
    if prior is not None:
        information = information + np.linalg.inv(prior)
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
