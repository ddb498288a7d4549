"""Faces of a CAD part, chosen by words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import PlainValidator

from castx.errors import CaseError
from castx.input.entries import Description, EntryName, Quantity, Whole
from castx.input.problems import Problem, refuse
from castx.input.units import ANGLE, LENGTH, PURE_NUMBER

Vector = tuple[float, float, float]

_COORDINATE = Quantity(LENGTH)
_COMPONENT = Quantity(PURE_NUMBER)
_AXES = ("x", "y", "z")


def unit_vector(value: Any) -> Vector:
    """Return a direction as a unit vector: "+z", "-x" or three numbers.

    Raises:
        CaseError: it is none.
    """
    if isinstance(value, str) and value[:1] in "+-" and value[1:] in _AXES:
        along = [0.0, 0.0, 0.0]
        along[_AXES.index(value[1:])] = 1.0 if value[0] == "+" else -1.0
        return along[0], along[1], along[2]
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise CaseError('a direction is needed: "+x", "-z", … or three numbers [1, 0, 1]')
    numbers = vector(value, _COMPONENT)
    length = math.hypot(*numbers)
    if length == 0.0:
        raise CaseError("the direction has no length")
    return numbers[0] / length, numbers[1] / length, numbers[2] / length


def vector(value: Any, kind: Quantity) -> Vector:
    """Return three numbers.

    Args:
        value: as given.
        kind: of the numbers.

    Raises:
        Refusal: with the offending one.
    """
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise CaseError("three numbers are needed")
    numbers = []
    for index, number in enumerate(value):
        try:
            numbers.append(kind.read(number))
        except CaseError as error:
            raise refuse(str(error), index) from None
    return numbers[0], numbers[1], numbers[2]


def point(value: Any) -> Vector:
    """Return three coordinates [m].

    Raises:
        CaseError: they are none.
    """
    return vector(value, _COORDINATE)


def box(value: Any) -> tuple[Vector, Vector]:
    """Return the lowest and the highest corner of a box [m].

    Raises:
        CaseError: there are no two corners, or the first is not below the second.
    """
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise CaseError("a box is needed: [[x, y, z], [x, y, z]], its lowest and highest corner")
    lowest, highest = point(value[0]), point(value[1])
    for index, (low, high) in enumerate(zip(lowest, highest, strict=True)):
        if low > high:
            raise refuse("must not be less than in the first corner", 1, index)
    return lowest, highest


class FaceSelector(Description):
    """Conditions for the faces of a named surface; a face must meet all of them.

    Attributes:
        body: that the faces belong to.
        normal: outward direction, a unit vector.
        angle: largest angle between it and the normals of a face [°].
        within: box that contains the faces [m].
        touches: body on the other side; None: free faces.
        radius: of curvature [m].
        largest: how many of the remaining faces, by area.
    """

    body: EntryName | None = None
    normal: Annotated[Vector | None, PlainValidator(unit_vector)] = None
    angle: Annotated[float, Quantity(ANGLE, above=0.0, most=180.0)] = 1.0
    within: Annotated[tuple[Vector, Vector] | None, PlainValidator(box)] = None
    touches: EntryName | None = None
    radius: Annotated[float | None, Quantity(LENGTH, above=0.0)] = None
    largest: Annotated[int | None, Whole(1, 10_000)] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a selector of nothing, and an angle from nothing."""
        if not self.model_fields_set:
            text = "says nothing; give body, normal, within, touches, radius or largest"
            yield Problem((), text)
        if "angle" in self.model_fields_set and self.normal is None:
            yield Problem(("angle",), "is that to `normal`, which is missing")
        if self.body is not None and self.body == self.touches:
            yield Problem(("touches",), "must be another body than `body`")
