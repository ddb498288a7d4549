"""Curves that identified numbers predict, and unknown tables, with their 95 % bands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.identification.covariance import band
from castx.foundry.identification.fit import Fit
from castx.report.page.charts import OVER_TIME
from castx.studies.asked.unknowns import LOG
from castx.studies.inverse.parameters import SoughtValues
from castx.studies.inverse.sensors import Sensors


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


def curve_bands(sensors: Sensors, found: Fit) -> list[Prediction]:
    """Return the curves of all sensors, at the moments of their samples.

    They are those of the places and the clock that were found, and their bands hold what is not
    known of these too.

    Args:
        sensors: with their samples.
        found: the fit.
    """
    computed = sensors.parts(sensors.measured - found.residuals)
    halves = sensors.parts(band(found.sensitivity, found.widened))
    return [
        Prediction(one.asked.of, one.time, value, value - half, value + half)
        for one, value, half in zip(sensors.sensors, computed, halves, strict=True)
    ]
