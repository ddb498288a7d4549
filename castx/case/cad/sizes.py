"""Sizes of cells at places of a CAD part."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated

from pydantic import PlainValidator

from castx.case.cad.selectors import Vector, box
from castx.input.entries import Description, EntryName, Quantity
from castx.input.problems import Problem
from castx.input.units import LENGTH


class LocalSize(Description):
    """A largest size of cells in a body, on a surface or in a box.

    Attributes:
        size: of the cells [m].
        body: the body.
        surface: a name of `surfaces`, on whatever body.
        within: the box, by its lowest and highest corner [m].
    """

    size: Annotated[float, Quantity(LENGTH, above=0.0)]
    body: EntryName | None = None
    surface: EntryName | None = None
    within: Annotated[tuple[Vector, Vector] | None, PlainValidator(box)] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a size of no place or of several."""
        given = [key for key in ("body", "surface", "within") if getattr(self, key) is not None]
        if len(given) != 1:
            yield Problem((), "give one of body, surface and within")
