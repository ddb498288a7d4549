"""A measured curve from which numbers of the case are identified."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, PlainValidator

from castx.case.output import DIMENSIONS, Measurement
from castx.errors import CaseError
from castx.input.entries import Quantity
from castx.input.problems import Problem
from castx.input.units import LENGTH, PURE_NUMBER, TEMPERATURE, TEMPERATURE_DIFFERENCE, number


def _kept(value: Any) -> Any:
    return value


class SensorCurve(Measurement):
    """A measured curve with its noise, and what is not known of its sensor.

    Attributes:
        noise: standard deviation of its samples, in SI or with a unit.
        depth_deviation: how well the place of the sensor is known [m]; None: it is.
        direction: in which the place of a probe without `below` is uncertain.
    """

    noise: Annotated[Any, PlainValidator(_kept)]
    depth_deviation: Annotated[float | None, Quantity(LENGTH, above=0.0)] = None
    direction: (
        Annotated[
            tuple[Annotated[float, Quantity(PURE_NUMBER)], ...], Field(min_length=2, max_length=3)
        ]
        | None
    ) = None

    @property
    def probe(self) -> str:
        """Name of the probe of the sensor."""
        return self.of.partition(".")[0]

    @property
    def sigma(self) -> float:
        """Standard deviation of the samples, SI."""
        dimension = DIMENSIONS[self.of.split(".")[1]]
        return number(self.noise, TEMPERATURE_DIFFERENCE if dimension is TEMPERATURE else dimension)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield the problems of a measurement, and noise that is none."""
        found = list(super().inconsistencies())
        yield from found
        if found:
            return
        try:
            positive = self.sigma > 0.0
        except CaseError as error:
            yield Problem(("noise",), str(error))
            return
        if not positive:
            yield Problem(("noise",), "must be positive: no sensor is without noise")
        if self.direction is not None and not any(self.direction):
            yield Problem(("direction",), "a direction is needed, such as [1, 0]")
