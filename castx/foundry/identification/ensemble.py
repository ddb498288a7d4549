"""Interface data fitted to measured temperatures by an ensemble of runs, without slopes.

Ensemble Kalman inversion by several assimilations of the same samples with larger noise. Source: A.
A. Emerick, A. C. Reynolds, Ensemble smoother with multiple data assimilation, Comput. Geosci. 55
(2013) 3-15, equations 12 and 13. Of a linear model and a large ensemble it is exact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from castx.arrays import FloatArray
from castx.errors import UnsettledFit
from castx.foundry.identification.covariance import reduced_chi_square
from castx.foundry.identification.fit import Fit, Unknown

Models = Callable[[Sequence[Mapping[str, float]]], Sequence[FloatArray | None]]
"""Samples of several named values at once, None of runs that fail."""
MEMBERS, ROUNDS = 32, 4
FEWEST = 0.5
"""Share of an ensemble that has to be left."""


def assimilate(
    models: Models,
    measured: FloatArray,
    noise: FloatArray,
    unknowns: Sequence[Unknown],
    prior: FloatArray,
    members: int = MEMBERS,
    rounds: int = ROUNDS,
    seed: int = 0,
) -> Fit:
    """Fit unknowns of models to measured samples by an ensemble; its mean and spread are the fit.

    Members whose runs fail are left out.

    Args:
        models: asked `rounds` + 1 times for all members, and once for their mean.
        measured: y, (samples,).
        noise: σ of the samples, one number or (samples,).
        unknowns: what is fitted.
        prior: Γ about their starts, (unknowns, unknowns).
        members: of the ensemble, more than unknowns.
        rounds: assimilations; more of them follow a model that bends.
        seed: of the draws.

    Raises:
        UnsettledFit: most runs fail.
        ValueError: there are not more members than unknowns.
    """
    if members < len(unknowns) + 2:
        raise ValueError(f"{len(unknowns)} unknowns need at least {len(unknowns) + 2} members")
    random = np.random.default_rng(seed)
    sigma = np.broadcast_to(np.asarray(noise, dtype=np.float64), measured.shape)
    bounds = np.array([unknown.bounds for unknown in unknowns]).T
    first = np.array([unknown.first for unknown in unknowns])
    points = np.clip(random.multivariate_normal(first, prior, members), *bounds)
    asked = 0
    for _ in range(rounds):
        points, samples = _living(models, unknowns, points, members)
        asked += members
        drawn = measured + np.sqrt(rounds) * sigma * random.normal(size=samples.shape)
        points = np.clip(points + _gain(points, samples, rounds * sigma**2, drawn), *bounds)
    points, samples = _living(models, unknowns, points, members)
    middle = points.mean(axis=0)
    (computed,) = models([_values(unknowns, middle)])
    if computed is None:
        raise UnsettledFit("the run with the mean of the ensemble fails")
    covariance = np.atleast_2d(np.cov(points.T))
    apart = points - middle, samples - samples.mean(axis=0)
    sensitivity = np.linalg.lstsq(*apart, rcond=None)[0].T
    residuals = measured - computed
    return Fit(
        _values(unknowns, middle),
        middle,
        covariance,
        reduced_chi_square(residuals, sigma, sensitivity, covariance),
        residuals,
        sensitivity,
        asked + members + 1,
    )


def _values(unknowns: Sequence[Unknown], point: FloatArray) -> dict[str, float]:
    return {one.name: one.value(theta) for one, theta in zip(unknowns, point, strict=True)}


def _living(
    models: Models, unknowns: Sequence[Unknown], points: FloatArray, members: int
) -> tuple[FloatArray, FloatArray]:
    """Return the points whose runs succeed, and their samples.

    Raises:
        UnsettledFit: too few are left.
    """
    found = models([_values(unknowns, point) for point in points])
    lives = [k for k, samples in enumerate(found) if samples is not None]
    if len(lives) < max(FEWEST * members, len(unknowns) + 2):
        raise UnsettledFit(f"only {len(lives)} of {members} runs of the ensemble are left")
    return points[lives], np.array([found[k] for k in lives])


def _gain(
    points: FloatArray, samples: FloatArray, variance: FloatArray, drawn: FloatArray
) -> FloatArray:
    """Return C_θy (C_yy + α R)⁻¹ (y + √α ε - G(θ)) of each member, (members, unknowns)."""
    theta, computed = points - points.mean(axis=0), samples - samples.mean(axis=0)
    weights = 1.0 / (len(points) - 1.0)
    matrix = weights * computed.T @ computed + np.diag(variance)
    return np.asarray(
        np.linalg.solve(matrix, (drawn - samples).T).T @ (weights * computed.T @ theta)
    )
