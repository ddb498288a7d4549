"""Interface data fitted to measured temperatures: Levenberg and Marquardt over any model.

A model is a function of named values, such as the run of a case that returns the samples of its
sensors. Source of the method: K. Levenberg, Q. Appl. Math. 2 (1944) 164-168, D. W. Marquardt, SIAM
J. Appl. Math. 11 (1963) 431-441, as the trust region of `scipy.optimize.least_squares`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from castx.arrays import FloatArray
from castx.errors import ConvergenceError
from castx.foundry.identification.covariance import (
    deviations,
    posterior,
    reduced_chi_square,
    weighted,
    widened,
)

Model = Callable[[Mapping[str, float]], FloatArray]
"""Samples of named values, (samples,); a run that fails raises `ConvergenceError`."""
SETTLED = 0.02
"""Step, in posterior deviations, below which a fit has settled."""
TRIES = 60


@dataclass(frozen=True)
class Unknown:
    """A number that is fitted.

    Attributes:
        name: by which the model knows it.
        start: its value at the start, and the one known before.
        difference: forward difference for its slope, in its unit, or of ln if positive: usual are
            0.01 of ln h, 1e-4 m of a depth, 0.1 s. What the tolerances of the model change has to
            be a hundred times smaller.
        deviation: of what is known before, in its unit, or of ln if positive; infinite: nothing is.
        positive: whether its logarithm is fitted.
    """

    name: str
    start: float
    difference: float
    deviation: float = np.inf
    positive: bool = False

    @property
    def first(self) -> float:
        """Fitted number at the start, a logarithm if positive."""
        return float(np.log(self.start)) if self.positive else self.start

    def value(self, fitted: float) -> float:
        """Return the value of the unknown from its fitted number."""
        return float(np.exp(fitted)) if self.positive else float(fitted)


@dataclass(frozen=True, eq=False)
class Fit:
    """Result of a fit to measured samples.

    Attributes:
        values: of the unknowns.
        fitted: the same, positive ones as logarithms, (unknowns,).
        covariance: C of `fitted` if the noise is what was said.
        chi_square: χ²_r; far above 1 the model lacks something.
        residuals: measured less modelled, (samples,).
        sensitivity: J by `fitted`, (samples, unknowns).
        runs: how often the model was asked.
    """

    values: dict[str, float]
    fitted: FloatArray
    covariance: FloatArray
    chi_square: float
    residuals: FloatArray
    sensitivity: FloatArray
    runs: int

    @property
    def widened(self) -> FloatArray:
        """C max(1, χ²_r)."""
        return widened(self.covariance, self.chi_square)


class _Settled(Exception):
    """The next step would be small beside the posterior deviations."""


class _Misfit:
    """Residuals of Φ = ½ Σ ((y - T)/σ)² + ½ (θ - θ_0)ᵀ Γ⁻¹ (θ - θ_0) + ½ ‖S θ‖²/γ²."""

    def __init__(
        self,
        model: Model,
        measured: FloatArray,
        noise: FloatArray,
        unknowns: Sequence[Unknown],
        smoothness: FloatArray | None,
    ) -> None:
        self.model, self.measured, self.unknowns = model, measured, unknowns
        self.noise = np.broadcast_to(np.asarray(noise, dtype=np.float64), measured.shape)
        self.first = np.array([unknown.first for unknown in unknowns])
        known = np.diag([1.0 / unknown.deviation for unknown in unknowns])
        known = known[np.diag(known) > 0.0]
        smooth = np.zeros((0, len(unknowns))) if smoothness is None else smoothness
        self.constraints = np.vstack([known, smooth])
        self.target = np.concatenate([known @ self.first, np.zeros(len(smooth))])
        self.runs = 0
        self.last: tuple[FloatArray, FloatArray] = (self.first, self.samples(self.first))
        self.linearised: tuple[FloatArray, FloatArray, FloatArray] | None = None

    def samples(self, fitted: FloatArray) -> FloatArray:
        """Return the samples computed by the model."""
        self.runs += 1
        pairs = zip(self.unknowns, fitted, strict=True)
        return np.asarray(self.model({u.name: u.value(theta) for u, theta in pairs}))

    def residuals(self, fitted: FloatArray) -> FloatArray:
        """Return the roots of the terms of 2 Φ, infinite where a run fails: a refused step."""
        if not np.array_equal(fitted, self.last[0]):
            try:
                self.last = fitted.copy(), self.samples(fitted)
            except ConvergenceError:
                return np.full(len(self.measured) + len(self.target), np.inf)
        misfit = (self.last[1] - self.measured) / self.noise
        return np.concatenate([misfit, self.constraints @ fitted - self.target])

    def sensitivity(self, fitted: FloatArray) -> FloatArray:
        """Return J by forward differences; by backward ones where a run fails."""
        self.residuals(fitted)
        here = self.last[1]
        columns = []
        for k, unknown in enumerate(self.unknowns):
            step = np.zeros(len(fitted))
            step[k] = unknown.difference
            try:
                columns.append((self.samples(fitted + step) - here) / unknown.difference)
            except ConvergenceError:
                columns.append((here - self.samples(fitted - step)) / unknown.difference)
        return np.column_stack(columns)

    def jacobian(self, fitted: FloatArray) -> FloatArray:
        """Return the slopes of the residuals, or end the fit where the next step is small."""
        changes = self.sensitivity(fitted)
        slopes = np.vstack([weighted(changes, self.noise), self.constraints])
        covariance = posterior(slopes, np.array(1.0))
        self.linearised = fitted.copy(), changes, covariance
        step = covariance @ (slopes.T @ self.residuals(fitted))
        if np.all(np.abs(step) < SETTLED * deviations(covariance)):
            raise _Settled
        return slopes


def fit(
    model: Model,
    measured: FloatArray,
    noise: FloatArray,
    unknowns: Sequence[Unknown],
    smoothness: FloatArray | None = None,
    tries: int = TRIES,
) -> Fit:
    """Fit unknowns of a model to measured samples; prior knowledge counts as further samples.

    It ends where the next full step is less than 2 % of each posterior deviation. A run that fails
    is a refused step: a smaller one is tried.

    Args:
        model: asked once for each step, and once for each unknown after it.
        measured: y, (samples,).
        noise: σ of the samples, one number or (samples,).
        unknowns: what is fitted.
        smoothness: S/γ, (rows, unknowns), see `smoothness.second_differences`.
        tries: how many steps at most, refused ones too.

    Raises:
        ConvergenceError: the model fails at the start, or the fit does not settle.
        ValueError: the samples do not tell all unknowns apart, and nothing known before does.
    """
    misfit = _Misfit(model, measured, noise, unknowns, smoothness)
    small = 10 * float(np.finfo(np.float64).eps)
    try:
        least_squares(
            misfit.residuals, misfit.first, misfit.jacobian, x_scale="jac",
            ftol=small, xtol=small, gtol=small, max_nfev=tries,
        )  # fmt: skip
    except _Settled:
        return _found(misfit)
    raise ConvergenceError(f"the fit has not settled after {misfit.runs} runs of the model")


def _found(misfit: _Misfit) -> Fit:
    assert misfit.linearised is not None  # a fit settles at its slopes
    fitted, changes, covariance = misfit.linearised
    residuals = -misfit.residuals(fitted)[: len(misfit.measured)] * misfit.noise
    pairs = zip(misfit.unknowns, fitted, strict=True)
    return Fit(
        {unknown.name: unknown.value(theta) for unknown, theta in pairs},
        fitted,
        covariance,
        reduced_chi_square(residuals, misfit.noise, changes, covariance),
        residuals,
        changes,
        misfit.runs,
    )
