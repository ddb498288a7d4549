"""Combinations of parameters that samples do not see, and that only the prior holds.

Source: T. Cui, J. Martin, Y. M. Marzouk, A. Solonen, A. Spantini, Likelihood-informed dimension
reduction for nonlinear inverse problems, Inverse Problems 30 (2014) 114015: what samples tell of a
direction against the prior are the singular values of the whitened sensitivity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.identification.covariance import weighted

LARGE = 0.5
"""Share of the largest part from which on a part names a direction."""


@dataclass(frozen=True)
class Direction:
    """A direction of whitened parameters, and its information from samples.

    Attributes:
        singular_value: of W^½ J Γ^½; below 1 the prior tells more than the samples.
        parts: of the parameters, each in deviations of the prior, of length 1.
        names: of the parameters with the largest parts, the largest first.
    """

    singular_value: float
    parts: FloatArray
    names: tuple[str, ...]


def unseen(
    sensitivity: FloatArray, noise: FloatArray, prior: FloatArray, names: Sequence[str]
) -> tuple[Direction, ...]:
    """Return the right singular vectors of W^½ J Γ^½ with singular values below 1, least first.

    Args:
        sensitivity: J, (samples, parameters).
        noise: σ of the samples, one number or (samples,).
        prior: Γ, (parameters, parameters), positive definite.
        names: of the parameters.
    """
    scale, axes = np.linalg.eigh(prior)
    root = (axes * np.sqrt(scale)) @ axes.T
    _, values, vectors = np.linalg.svd(weighted(sensitivity, noise) @ root)
    told = np.zeros(len(vectors))
    told[: len(values)] = values
    return tuple(
        Direction(float(told[k]), vectors[k], _named(vectors[k], names))
        for k in np.argsort(told)
        if told[k] < 1.0
    )


def _named(parts: FloatArray, names: Sequence[str]) -> tuple[str, ...]:
    size = np.abs(parts)
    largest = size.max()
    return tuple(names[k] for k in np.argsort(-size, kind="stable") if size[k] >= LARGE * largest)
