"""A place where a thermocouple might lie."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field

from castx.input.entries import Description, EntryName, Quantity
from castx.input.problems import Problem
from castx.input.units import LENGTH, PURE_NUMBER, TEMPERATURE_DIFFERENCE

DEPTH = 3e-4
"""Usual deviation of the place of a thermocouple in a drilled hole [m]."""


class CandidateSensor(Description):
    """A candidate of `castx identify --design`.

    Attributes:
        name: of the place.
        body: in which it lies.
        below: interface or surface from which its depth is measured.
        depth: into the body [m].
        at: coordinates, those of the surface with `below` [m].
        direction: in which the place is uncertain, without `below`.
        noise: standard deviation of its samples [K].
        depth_deviation: how well its place will be known [m]; 0: exactly.
    """

    name: EntryName
    body: str
    below: str | None = None
    depth: Annotated[float, Quantity(LENGTH, least=0.0)] = 0.0
    at: Annotated[tuple[Annotated[float, Quantity(LENGTH)], ...], Field(min_length=2, max_length=3)]
    direction: (
        Annotated[
            tuple[Annotated[float, Quantity(PURE_NUMBER)], ...], Field(min_length=2, max_length=3)
        ]
        | None
    ) = None
    noise: Annotated[float, Quantity(TEMPERATURE_DIFFERENCE, above=0.0)] = 1.0
    depth_deviation: Annotated[float, Quantity(LENGTH, least=0.0)] = DEPTH

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield an uncertain place without a direction."""
        if self.depth_deviation > 0.0 and self.below is None and not any(self.direction or ()):
            text = 'is needed where depth_deviation is not 0 and there is no "below": [1, 0]'
            yield Problem(("direction",), text)
        if self.direction is not None and len(self.direction) != len(self.at):
            yield Problem(("direction",), f"needs as many numbers as at, {len(self.at)}")
        if self.depth > 0.0 and self.below is None:
            yield Problem(("depth",), 'needs the surface from which it is measured: "below"')

    def probes(self, shift: float) -> list[dict[str, Any]]:
        """Return probes as a case file has them: at the place, and deeper by a shift [m]."""
        base: dict[str, Any] = {"body": self.body, "quantities": ["temperature"]}
        if self.below is not None:
            base |= {"below": self.below, "at": list(self.at)}
            places: list[dict[str, Any]] = [{"depth": self.depth}, {"depth": self.depth + shift}]
        else:
            along = self.direction or (0.0,) * len(self.at)
            length = sum(x * x for x in along) ** 0.5 or 1.0
            moved = [x + shift * d / length for x, d in zip(self.at, along, strict=False)]
            places = [{"at": list(self.at)}, {"at": moved}]
        names = (self.name, f"{self.name} deeper")
        return [{**base, **place, "name": name} for place, name in zip(places, names, strict=True)]
