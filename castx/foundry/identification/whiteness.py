"""Whether the residuals of a fit are noise: the test of Ljung and Box.

Source: G. M. Ljung, G. E. P. Box, On a measure of lack of fit in time series models, Biometrika 65
(1978) 297-303.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from castx.arrays import FloatArray

LAGS = 10
LEVEL = 0.05
"""How often noise alone is taken for more than noise."""


def ljung_box(residuals: FloatArray, lags: int = LAGS) -> float:
    """Return Q = n (n + 2) Σ_k ρ_k²/(n - k) with ρ_k = Σ r_i r_(i+k)/Σ r_i².

    The mean is not taken off: a constant error of a sensor is no noise.

    Args:
        residuals: r of one sensor at even intervals, (samples,).
        lags: up to which k.

    Raises:
        ValueError: there are not more samples than lags, or all residuals are 0.
    """
    r = np.asarray(residuals, dtype=np.float64)
    square = float(r @ r)
    if len(r) <= lags or square == 0.0:
        raise ValueError(f"whiteness over {lags} lags needs more samples than that, not all 0")
    lag = np.arange(1, lags + 1)
    correlations = np.array([r[:-k] @ r[k:] for k in lag]) / square
    return float(len(r) * (len(r) + 2) * np.sum(correlations**2 / (len(r) - lag)))


def limit(lags: int = LAGS, level: float = LEVEL) -> float:
    """Return the quantile of Q of white noise at a probability: 18.307 of 10 lags and 5 %."""
    return float(chi2.ppf(1.0 - level, lags))


def lacking(residuals: FloatArray, sensors: Sequence[str], lags: int = LAGS) -> tuple[str, ...]:
    """Return a sentence for each sensor whose residuals are more than noise.

    Args:
        residuals: (sensors, samples).
        sensors: their names.
        lags: see `ljung_box`.
    """
    bound = limit(lags)
    found = [ljung_box(row, lags) for row in residuals]
    return tuple(
        f"{name}: noise is not what the model lacks, its residuals hang together "
        f"(Ljung-Box {q:.1f}, limit {bound:.1f})"
        for name, q in zip(sensors, found, strict=True)
        if q > bound
    )
