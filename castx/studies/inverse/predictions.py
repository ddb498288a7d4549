"""Curves that identified numbers predict, and unknown tables, with their 95 % bands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.errors import ConvergenceError
from castx.foundry.identification.covariance import band
from castx.foundry.identification.fit import Fit, Unknown
from castx.report.page.charts import OVER_TIME
from castx.studies.asked.unknowns import LOG
from castx.studies.inverse.model import MeasuredCase
from castx.studies.inverse.parameters import SoughtValues


@dataclass(frozen=True, eq=False)
class Prediction:
    """A curve with its 95 % band.

    Attributes:
        name: of it.
        argument: (points,).
        value: (points,).
        low: lower end of the band, (points,).
        high: upper end, (points,).
        abscissa: label of the argument, with its unit.
        unit: of the values, "" if plain.
    """

    name: str
    argument: FloatArray
    value: FloatArray
    low: FloatArray
    high: FloatArray
    abscissa: str = OVER_TIME
    unit: str = ""


def table_bands(sought: Sequence[SoughtValues], found: Fit) -> list[Prediction]:
    """Return the unknown tables between their knots, by their covariance.

    Args:
        sought: unknowns of the case, the first numbers of the fit.
        found: the fit.
    """
    bands, first = [], 0
    for one in sought:
        count = len(one.names)
        if one.asked.is_table:
            at = one.fine_knots()
            part = found.widened[first : first + count, first : first + count]
            weights = np.array([np.interp(at, one.knots, row) for row in np.eye(count)]).T
            middle, half = weights @ found.fitted[first : first + count], band(weights, part)
            value, low, high = middle, middle - half, middle + half
            if one.asked.scale == LOG:
                value, low, high = np.exp(value), np.exp(low), np.exp(high)
            whole = Prediction(one.asked.name, at, value, low, high, one.abscissa, one.shown_unit)
            bands.append(whole)
        first += count
    return bands


def probe_bands(
    model: MeasuredCase, unknowns: Sequence[Unknown], found: Fit, columns: Sequence[str]
) -> list[Prediction]:
    """Return the curves of probes that the identified numbers predict.

    Depths and clocks of sensors are not in them: they are those of the case at its own places.

    Args:
        model: the measured case.
        unknowns: what was fitted.
        found: the fit.
        columns: of probes.csv.
    """
    here = model.columns(found.values)
    time = here["time"]
    numbers = len(model.parameters.unknowns())
    changes = {name: np.zeros((len(time), numbers)) for name in columns}
    moved = [_moved(unknowns, found, k) for k in range(numbers)]
    model.ahead(moved)
    for k, values in enumerate(moved):
        step = unknowns[k].difference
        try:
            there = model.columns(values)
        except ConvergenceError:
            continue
        for name in columns:
            other = np.interp(time, there["time"], there[name])
            changes[name][:, k] = (other - here[name]) / step
    part = found.widened[:numbers, :numbers]
    bands = []
    for name in columns:
        half = band(changes[name], part)
        bands.append(Prediction(name, time, here[name], here[name] - half, here[name] + half))
    return bands


def _moved(unknowns: Sequence[Unknown], found: Fit, k: int) -> Mapping[str, float]:
    fitted = found.fitted.copy()
    fitted[k] += unknowns[k].difference
    return {one.name: one.value(theta) for one, theta in zip(unknowns, fitted, strict=True)}
