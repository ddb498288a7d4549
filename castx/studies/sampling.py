"""Where a study runs its case: points of the unit cube, one for each run.

Sources: M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21 (1979) 239-245 (Latin
hypercube); M. D. Morris, Technometrics 33 (1991) 161-174 (paths); A. Saltelli et al., Comput. Phys.
Commun. 181 (2010) 259-270 (points for shares of the variance). Points of Latin hypercube and Sobol
are those of `scipy.stats.qmc`.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.stats import qmc

from castx.arrays import FloatArray

LEVELS = 4
STEP = LEVELS / (2.0 * (LEVELS - 1))
"""Length of a step of a path: with it all levels are met equally often (Morris 1991, section 3)."""


def latin_hypercube(inputs: int, runs: int, seed: int) -> FloatArray:
    """Return points of which each slice of each input has one, (runs, inputs)."""
    sampler = qmc.LatinHypercube(inputs, seed=np.random.default_rng(seed))
    return np.asarray(sampler.random(runs))


def grid(points: list[FloatArray]) -> FloatArray:
    """Return all combinations of the points of the inputs, (runs, inputs), the last one fastest."""
    return np.array(list(product(*points)), dtype=np.float64)


def morris_paths(inputs: int, paths: int, seed: int) -> FloatArray:
    """Return paths along which one input after another moves, (paths (inputs + 1), inputs)."""
    random = np.random.default_rng(seed)
    lower = np.arange(LEVELS // 2) / (LEVELS - 1.0)
    found = []
    for _ in range(paths):
        upward = random.random(inputs) < 0.5
        start = random.choice(lower, inputs)
        point = np.where(upward, start, start + STEP)
        found.append(point.copy())
        for k in random.permutation(inputs):
            point[k] += STEP if upward[k] else -STEP
            found.append(point.copy())
    return np.array(found)


def saltelli_points(inputs: int, draws: int, seed: int) -> FloatArray:
    """Return the points A, B and A with each input of B, (draws (inputs + 2), inputs).

    Args:
        inputs: how many.
        draws: a power of two.
        seed: of the points.
    """
    sampler = qmc.Sobol(2 * inputs, seed=np.random.default_rng(seed))
    both = np.asarray(sampler.random(draws))
    first, second = both[:, :inputs], both[:, inputs:]
    mixed = []
    for k in range(inputs):
        points = first.copy()
        points[:, k] = second[:, k]
        mixed.append(points)
    return np.vstack([first, second, *mixed])
