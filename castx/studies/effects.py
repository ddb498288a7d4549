"""What a result hangs on, from runs at the points of `castx.studies.sampling`.

Runs that have failed have NaN as result; they are left out with what belongs to them. All inputs
are measured in the unit cube: from their lowest to their highest value.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.studies.sampling import STEP


@dataclass(frozen=True, eq=False)
class StraightLines:
    """A result as a straight line of all inputs.

    Attributes:
        slopes: change of the result as each input goes from its lowest to its highest value,
            (inputs,).
        explained: share of the variance that the lines explain; below 0.9 they are not enough.
    """

    slopes: FloatArray
    explained: float


def lines(points: FloatArray, result: FloatArray) -> StraightLines | None:
    """Return the straight lines that fit a result best; None of fewer runs than they need.

    Args:
        points: of the runs, (runs, inputs).
        result: theirs, NaN of failed ones, (runs,).
    """
    known = np.isfinite(result)
    x, y = points[known], result[known]
    if len(y) < x.shape[1] + 2 or np.linalg.matrix_rank(x - x.mean(axis=0)) < x.shape[1]:
        return None
    whole = np.column_stack([np.ones(len(x)), x])
    found, *_ = np.linalg.lstsq(whole, y, rcond=None)
    variance = float(np.var(y))
    left = float(np.var(y - whole @ found))
    return StraightLines(found[1:], 1.0 if variance == 0.0 else 1.0 - left / variance)


@dataclass(frozen=True, eq=False)
class Elementary:
    """Elementary effects of Morris: the change of a result per input, along paths.

    Attributes:
        mean: μ, (inputs,).
        strength: μ*, mean of their sizes, (inputs,).
        spread: σ: large beside μ* where the input acts in a curve or with others, (inputs,).
    """

    mean: FloatArray
    strength: FloatArray
    spread: FloatArray


def elementary(points: FloatArray, result: FloatArray) -> Elementary:
    """Return the effects of Morris; NaN of inputs along which no step has two results.

    Source: F. Campolongo, J. Cariboni, A. Saltelli, Environ. Model. Softw. 22 (2007) 1509-1518.

    Args:
        points: of `morris_paths`, (runs, inputs).
        result: of the runs, (runs,).
    """
    inputs = points.shape[1]
    effects: list[list[float]] = [[] for _ in range(inputs)]
    for start in range(0, len(points), inputs + 1):
        for run in range(start + 1, start + inputs + 1):
            moved = points[run] - points[run - 1]
            k = int(np.argmax(np.abs(moved)))
            effect = (result[run] - result[run - 1]) / (np.sign(moved[k]) * STEP)
            if np.isfinite(effect):
                effects[k].append(float(effect))

    def each(of: list[list[float]]) -> FloatArray:
        return np.array([np.mean(one) if one else np.nan for one in of])

    spread = [float(np.std(one, ddof=1)) if len(one) > 1 else np.nan for one in effects]
    sizes = [[abs(effect) for effect in one] for one in effects]
    return Elementary(each(effects), each(sizes), np.array(spread))


@dataclass(frozen=True, eq=False)
class VarianceShares:
    """Sobol indices of a result.

    Attributes:
        first: share of the variance that goes if the input is known, (inputs,).
        total: share that stays if all others are known, (inputs,).
        draws: of which they are made.
    """

    first: FloatArray
    total: FloatArray
    draws: int


def variance_shares(points: FloatArray, result: FloatArray) -> VarianceShares | None:
    """Return the Sobol indices; None of a result that does not vary, or of less than two draws.

    First-order indices after Saltelli et al. (2010), table 2 (b); total ones after Jansen, (f)
    there. A draw of which a run has failed is left out.

    Args:
        points: of `saltelli_points`, (runs, inputs).
        result: of the runs, (runs,).
    """
    inputs = points.shape[1]
    whole = result.reshape(inputs + 2, -1)
    found = whole[:, np.isfinite(whole).all(axis=0)]
    first, second, mixed = found[0], found[1], found[2:]
    if len(first) < 2:
        return None
    variance = float(np.var(np.concatenate([first, second])))
    if variance <= 1e-24 * float(np.max(np.abs(found))) ** 2:
        return None
    middle = float(np.mean(found[:2]))
    shares = ((second - middle) * (mixed - first)).mean(axis=1) / variance
    total = 0.5 * ((mixed - first) ** 2).mean(axis=1) / variance
    return VarianceShares(shares, total, len(first))
