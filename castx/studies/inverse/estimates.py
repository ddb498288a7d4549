"""What a fit has found, with its uncertainty, in numbers and in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.identification.covariance import BAND, correlation, deviations
from castx.foundry.identification.directions import Direction, unseen
from castx.foundry.identification.fit import Fit, Unknown
from castx.foundry.identification.whiteness import LAGS, limit, ljung_box

UNKNOWN_BEFORE = 3.0
"""Deviation of ln of an unknown of which nothing is known before, a factor of 20 to both sides, for
directions that samples do not see."""
ALMOST_SAME = 0.95
"""Correlation from which on two unknowns are said to be told apart badly."""
NEAR = 1e-3
"""Distance from a bound, in deviations, at which an estimate lies on it."""
LACKS = 2.0
"""χ²_r from which on the model is said to lack something."""


@dataclass(frozen=True)
class IdentifiedNumber:
    """A number that was identified.

    Attributes:
        name: of it.
        unit: of its values, "" if plain.
        value: the best one.
        low: end of its 95 % band.
        high: the other end.
        deviation: of what was fitted: of ln if its logarithm was.
        logarithmic: whether it was.
        start: what it began with.
        known: deviation of what was known before; infinite: nothing was.
        at_bound: whether a bound holds it.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    deviation: float
    logarithmic: bool
    start: float
    known: float
    at_bound: bool


@dataclass(frozen=True, eq=False)
class Estimates:
    """All that a fit has found.

    Attributes:
        fit: the fit.
        estimates: of the unknowns, in their order.
        whiteness: of each sensor, in words.
        unseen: directions that the samples do not see, in words.
        remarks: what else is to be known, in words.
    """

    fit: Fit
    estimates: Sequence[IdentifiedNumber]
    whiteness: Sequence[str]
    unseen: Sequence[str]
    remarks: Sequence[str]


def estimates(
    found: Fit,
    unknowns: Sequence[Unknown],
    units: Sequence[str],
    noise: FloatArray,
    smoothness: FloatArray | None,
    residuals: Sequence[tuple[str, FloatArray]],
) -> Estimates:
    """Return the estimates of a fit, in numbers and words.

    Args:
        found: the fit.
        unknowns: what was fitted.
        units: of the unknowns.
        noise: σ of the samples, (samples,).
        smoothness: S/γ, (rows, unknowns).
        residuals: name and residuals of each sensor.
    """
    sigmas = deviations(found.widened)
    numbers = [
        _estimate(unknown, unit, float(theta), float(sigma))
        for unknown, unit, theta, sigma in zip(unknowns, units, found.fitted, sigmas, strict=True)
    ]
    directions = unseen(
        found.sensitivity, noise, prior_covariance(unknowns, smoothness),
        [unknown.name for unknown in unknowns],
    )  # fmt: skip
    return Estimates(
        found,
        numbers,
        [whiteness_sentence(name, values) for name, values in residuals],
        [unseen_sentence(one) for one in directions],
        list(_remarks(found, numbers, unknowns)),
    )


def _estimate(unknown: Unknown, unit: str, theta: float, sigma: float) -> IdentifiedNumber:
    low, high = unknown.bounds
    near = NEAR * sigma
    return IdentifiedNumber(
        unknown.name, unit, unknown.value(theta),
        unknown.value(theta - BAND * sigma), unknown.value(theta + BAND * sigma), sigma,
        unknown.positive, unknown.start, unknown.deviation,
        bool(theta - low < near or high - theta < near),
    )  # fmt: skip


def prior_covariance(unknowns: Sequence[Unknown], smoothness: FloatArray | None) -> FloatArray:
    """Return Γ of all that is known before, (unknowns, unknowns); see `UNKNOWN_BEFORE`.

    Args:
        unknowns: what is fitted.
        smoothness: S/γ, (rows, unknowns).
    """
    known = np.array([_known(unknown) for unknown in unknowns])
    information = np.diag(1.0 / known**2)
    if smoothness is not None:
        information = information + smoothness.T @ smoothness
    return np.asarray(np.linalg.inv(information))


def _known(unknown: Unknown) -> float:
    if np.isfinite(unknown.deviation):
        return unknown.deviation
    if unknown.positive:
        return UNKNOWN_BEFORE
    span = unknown.high - unknown.low
    return 0.5 * span if np.isfinite(span) else abs(unknown.start) or 1.0


def whiteness_sentence(sensor: str, residuals: FloatArray) -> str:
    """Return whether the residuals of a sensor are noise, in words."""
    bound = limit()
    try:
        q = ljung_box(residuals, LAGS)
    except ValueError:
        return f"{sensor}: too few samples to tell noise from more."
    size = float(np.sqrt(np.mean(residuals**2)))
    told = f"{sensor}: root mean square {size:.3g}, Ljung-Box {q:.1f}, limit {bound:.1f}: "
    if q <= bound:
        return f"{told}noise."
    return f"{told}noise is not what the model lacks; its bands are too narrow."


def unseen_sentence(direction: Direction) -> str:
    """Return a direction that samples do not see, in words."""
    told = 1.0 / np.sqrt(1.0 + direction.singular_value**2)
    together = " with ".join(direction.names)
    what = together if len(direction.names) == 1 else f"{together} together"
    return (
        f"The samples hardly see {what}: its deviation is still {100.0 * told:.0f} % of that known "
        "before."
    )


def _remarks(
    found: Fit, numbers: Sequence[IdentifiedNumber], unknowns: Sequence[Unknown]
) -> list[str]:  # fmt: skip
    remarks = []
    if found.chi_square > LACKS:
        remarks.append(
            f"χ²_r is {found.chi_square:.3g}: residuals are larger than the noise that was said. "
            "The bands are widened for it, but a wrong model is not in them. See when they are "
            "large: a number that changes with time or gap wants a table (over, knots), a place "
            "its depth_deviation, a logger its clock_deviation."
        )
    held = [one.name for one in numbers if one.at_bound]
    if held:
        remarks.append(f"A bound holds {', '.join(held)}: widen it, or ask why.")
    together = np.abs(correlation(found.covariance))
    for i, first in enumerate(unknowns):
        for j in range(i + 1, len(unknowns)):
            if together[i, j] > ALMOST_SAME:
                remarks.append(
                    f"{first.name} and {unknowns[j].name} are told apart badly: their correlation "
                    f"is {correlation(found.covariance)[i, j]:.3f}."
                )
    return remarks
