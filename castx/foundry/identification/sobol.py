"""Sensitivity of a result to its inputs: first-order indices of Sobol for any model.

The index S_i = Var(E[Y | X_i])/Var(Y) is the share of the variance of a result that would go if the
input X_i were known; what the sum of all indices lacks of one is owed to inputs together. The
estimator is that of `scipy.stats.sobol_indices`: A. Saltelli et al., Variance based sensitivity
analysis of model output, Comput. Phys. Commun. 181 (2010) 259-270, with points after Sobol.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from scipy.stats import sobol_indices, uniform

from castx.arrays import FloatArray

Model = Callable[[Mapping[str, float]], float]
"""A result of named inputs, such as one number of a run of a case."""


def runs(draws: int, inputs: int) -> int:
    """Return the number of evaluations of a model."""
    return draws * (inputs + 2)


def first_order_indices(
    model: Model, bounds: Mapping[str, tuple[float, float]], draws: int = 256, seed: int = 0
) -> dict[str, float]:
    """Return the first-order index of each input, which lies evenly between its bounds.

    All are zero where the result is the same for all inputs.

    The error falls nearly as 1/draws for smooth models. Of a positive input that is known to a
    factor, a coefficient of heat transfer say, give the bounds of the logarithm.

    Args:
        model: asked `runs(draws, inputs)` times.
        bounds: lowest and highest value of each input.
        draws: a power of two.
        seed: of the points; the same one gives the same indices.

    Raises:
        ValueError: draws are no power of two, or bounds are not in order.
    """
    names = list(bounds)
    if any(not low < high for low, high in bounds.values()):
        raise ValueError("each input needs a lowest value below its highest one")

    def results(points: FloatArray) -> FloatArray:
        """Return the results at points (inputs, runs): (1, runs)."""
        rows = points.reshape(len(names), -1).T
        return np.array([[model(dict(zip(names, map(float, row), strict=True))) for row in rows]])

    found = sobol_indices(
        func=results,
        n=draws,
        dists=[uniform(low, high - low) for low, high in bounds.values()],
        random_state=np.random.default_rng(seed),
    )
    return dict(zip(names, map(float, np.ravel(found.first_order)), strict=True))
