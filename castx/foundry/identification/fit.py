"""Interface data fitted to measured temperatures: Levenberg and Marquardt over any model.

A model is a function of named values, such as the run of a case that returns the samples of its
sensors.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.errors import ConvergenceError, UnsettledFit
from castx.foundry.identification.covariance import (
    posterior,
    reduced_chi_square,
    weighted,
    widened,
)
from castx.foundry.identification.descent import descend
from castx.foundry.identification.directions import LARGE

Model = Callable[[Mapping[str, float]], FloatArray]
"""Samples of named values, (samples,); a run that fails raises `ConvergenceError`."""
Ahead = Callable[[Sequence[Mapping[str, float]]], None]
"""Told of values before a model is asked for them one by one, so that their runs go on at once."""
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
        low: smallest value that is tried, below the start.
        high: largest one, above the start.
    """

    name: str
    start: float
    difference: float
    deviation: float = np.inf
    positive: bool = False
    low: float = -np.inf
    high: float = np.inf

    @property
    def first(self) -> float:
        """Fitted number at the start, a logarithm if positive."""
        return float(np.log(self.start)) if self.positive else self.start

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest fitted number."""
        if not self.positive:
            return self.low, self.high
        low = float(np.log(self.low)) if self.low > 0.0 else -np.inf
        return low, float(np.log(self.high))

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


class _Misfit:
    """Residuals of Φ = ½ Σ ((y - T)/σ)² + ½ (θ - θ_0)ᵀ Γ⁻¹ (θ - θ_0) + ½ ‖S θ‖²/γ²."""

    def __init__(
        self,
        model: Model,
        measured: FloatArray,
        noise: FloatArray,
        unknowns: Sequence[Unknown],
        smoothness: FloatArray | None,
        ahead: Ahead | None,
    ) -> None:
        self.ahead = ahead
        self.bounds = np.array([unknown.bounds for unknown in unknowns]).T
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
        self.changes: FloatArray = np.zeros((len(measured), len(unknowns)))

    def samples(self, fitted: FloatArray) -> FloatArray:
        """Return the samples computed by the model."""
        self.runs += 1
        return np.asarray(self.model(self.values(fitted)))

    def values(self, fitted: FloatArray) -> dict[str, float]:
        """Return the values of the unknowns by their names."""
        pairs = zip(self.unknowns, fitted, strict=True)
        return {unknown.name: unknown.value(theta) for unknown, theta in pairs}

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
        steps = np.diag([unknown.difference for unknown in self.unknowns])
        if self.ahead is not None:
            self.ahead([self.values(fitted + step) for step in steps])
        for step, unknown in zip(steps, self.unknowns, strict=True):
            try:
                columns.append((self.samples(fitted + step) - here) / unknown.difference)
            except ConvergenceError:
                columns.append((here - self.samples(fitted - step)) / unknown.difference)
        return np.column_stack(columns)

    def slopes(self, fitted: FloatArray) -> FloatArray:
        """Return the slopes of the residuals."""
        self.changes = self.sensitivity(fitted)
        return self._rows()

    def _rows(self) -> FloatArray:
        return np.vstack([weighted(self.changes, self.noise), self.constraints])

    def hidden(self) -> list[str]:
        """Return the names of the unknowns whose common change the last slopes see least."""
        rows = self._rows()
        scale = np.linalg.norm(rows, axis=0)
        if not scale.all():
            return [one.name for one, size in zip(self.unknowns, scale, strict=True) if not size]
        scaled = rows / scale
        least = np.abs(np.linalg.eigh(scaled.T @ scaled)[1][:, 0])
        parts = zip(self.unknowns, least, strict=True)
        return [one.name for one, part in parts if part >= LARGE * least.max()]


def fit(
    model: Model,
    measured: FloatArray,
    noise: FloatArray,
    unknowns: Sequence[Unknown],
    smoothness: FloatArray | None = None,
    tries: int = TRIES,
    ahead: Ahead | None = None,
    reach: float = np.inf,
) -> Fit:
    """Fit unknowns of a model to measured samples; prior knowledge counts as further samples.

    It ends where the next full step, as far as bounds let it, is less than 2 % of each posterior
    deviation. A run that fails is a refused step: a smaller one is tried.

    Args:
        model: asked once for each step, and once for each unknown after it.
        measured: y, (samples,).
        noise: σ of the samples, one number or (samples,).
        unknowns: what is fitted.
        smoothness: S/γ, (rows, unknowns), see `smoothness.second_differences`.
        tries: how many steps at most, refused ones too.
        ahead: told of all values whose samples the next slopes need.
        reach: largest step of a logarithm.

    Raises:
        ConvergenceError: the model fails at the start.
        UnsettledFit: the fit does not settle.
        ValueError: the samples do not tell all unknowns apart, and nothing known before does; the
            message names those that they tell least.
    """
    misfit = _Misfit(model, measured, noise, unknowns, smoothness, ahead)
    low, high = misfit.bounds
    far = np.array([reach if unknown.positive else np.inf for unknown in unknowns])
    try:
        end = descend(misfit.residuals, misfit.slopes, misfit.first, (low, high), tries, far)
    except ConvergenceError:
        raise UnsettledFit(
            f"the fit has not settled after {misfit.runs} runs of the model"
        ) from None
    except ValueError as error:
        raise ValueError(f"{error}, least of all {', '.join(misfit.hidden())}") from None
    residuals = -misfit.residuals(end.point)[: len(measured)] * misfit.noise
    covariance = posterior(end.slopes, np.array(1.0))
    return Fit(
        misfit.values(end.point),
        end.point,
        covariance,
        reduced_chi_square(residuals, misfit.noise, misfit.changes, covariance),
        residuals,
        misfit.changes,
        misfit.runs,
    )
