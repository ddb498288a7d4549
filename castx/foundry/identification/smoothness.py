"""Smoothness of a curve that is fitted by its knots, as something known before.

A coefficient of heat transfer changes fast after pouring and slowly later, so its logarithm is held
smooth over ln(1 + t), t in s: a choice.
"""

from __future__ import annotations

import numpy as np

from castx.arrays import FloatArray


def second_differences(time: FloatArray) -> FloatArray:
    """Return S, second divided differences over s = ln(1 + t), (knots - 2, knots).

    S of a curve is f[s_k, s_k+1, s_k+2] = ((f_k+2 - f_k+1)/(s_k+2 - s_k+1) - (f_k+1 - f_k)/(s_k+1 -
    s_k))/(s_k+2 - s_k): 0 of a straight line, 1 of s². Divided by γ, the deviation that is expected
    of them, it is what `covariance.posterior` takes.

    Args:
        time: of the knots [s], rising, (knots,).

    Raises:
        ValueError: times do not rise, or are fewer than three.
    """
    place = np.log1p(np.asarray(time, dtype=np.float64))
    if len(place) < 3 or not np.all(np.diff(place) > 0.0):
        raise ValueError("smoothness needs at least three knots at rising times")
    slopes = np.diff(np.eye(len(place)), axis=0) / np.diff(place)[:, None]
    return np.asarray(np.diff(slopes, axis=0) / (place[2:] - place[:-2])[:, None])
