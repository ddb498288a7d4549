"""A mould that is made round the solids of CAD files: block or shell, halves, chills, cores."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, PlainValidator

from castx.case.cad.selectors import Vector, point
from castx.case.cad.selectors import box as corners
from castx.errors import CaseError
from castx.input.entries import Description, EntryName, Quantity
from castx.input.problems import Problem, Refusal, among, refuse
from castx.input.units import LENGTH

Box = tuple[Vector, Vector]

AXES = ("x", "y", "z")
_PLACE = Quantity(LENGTH)
_MARGIN = Quantity(LENGTH, above=0.0)
_MOST_CORNERS = 100
_MOST_PARTS = 100


def plane(value: Any, signs: tuple[str, ...]) -> tuple[int, str, float]:
    """Return axis, sign and place [m] of a plane, such as "z = 10 mm" or "x > 0".

    Args:
        value: as given.
        signs: that may stand between axis and place.

    Raises:
        CaseError: it is no plane.
    """
    words = value.split(maxsplit=2) if isinstance(value, str) else []
    if len(words) != 3 or words[0] not in AXES or words[1] not in signs:
        examples = " or ".join(f'"z {sign} 10 mm"' for sign in signs)
        raise CaseError(f"a plane across x, y or z is needed: {examples}")
    try:
        place: float | str = float(words[2])
    except ValueError:
        place = words[2]
    return AXES.index(words[0]), words[1], _PLACE.read(place)


def _split(value: Any) -> tuple[int, float]:
    axis, _, place = plane(value, ("=",))
    return axis, place


def symmetry_planes(value: Any) -> tuple[tuple[int, float, bool], ...]:
    """Return axis, place [m] and whether what lies above stays, of planes such as "x > 0".

    Raises:
        CaseError: there is none, or two on one axis.
    """
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= 3:
        raise CaseError('a list of 1 to 3 planes is needed: ["x > 0", "y < 10 mm"]')
    planes: list[tuple[int, float, bool]] = []
    for index, entry in enumerate(value):
        try:
            axis, sign, place = plane(entry, ("<", ">"))
        except CaseError as error:
            raise refuse(str(error), index) from None
        if axis in [other for other, _, _ in planes]:
            raise refuse("this axis has a plane already", index)
        planes.append((axis, place, sign == ">"))
    return tuple(planes)


def _line(value: Any) -> tuple[Vector, ...]:
    if not isinstance(value, list | tuple) or not 2 <= len(value) <= _MOST_CORNERS:
        raise CaseError("a line is needed: [[x, y, z], [x, y, z], …]")
    corners: list[Vector] = []
    for index, corner in enumerate(value):
        try:
            corners.append(point(corner))
        except Refusal as error:
            raise error.inside(index) from None
        except CaseError as error:
            raise refuse(str(error), index) from None
        if index and corners[-1] == corners[-2]:
            raise refuse("is the corner before again", index)
    return tuple(corners)


class CoolingChannel(Description):
    """A cooling channel that is drilled through the mould.

    Attributes:
        name: of the surface of its walls.
        line: corners of its axis [m].
        diameter: [m].
    """

    name: EntryName = "cooling"
    line: Annotated[tuple[Vector, ...], PlainValidator(_line)]
    diameter: Annotated[float, Quantity(LENGTH, above=0.0)]


class MouldChill(Description):
    """A chill, a box or a cylinder out of which the part is cut.

    Attributes:
        name: of its body.
        box: its lowest and highest corner [m].
        line: the two ends of the axis of a cylinder [m].
        diameter: of the cylinder [m].
    """

    name: EntryName
    box: Annotated[Box | None, PlainValidator(corners)] = None
    line: Annotated[tuple[Vector, ...], PlainValidator(_line)] = ()
    diameter: Annotated[float | None, Quantity(LENGTH, above=0.0)] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a chill that is no box and no cylinder."""
        if (self.box is None) == (not self.line):
            yield Problem((), "give either box, or line and diameter")
        elif self.line and (len(self.line) != 2 or self.diameter is None):
            yield Problem((), "a cylinder needs line = [[x, y, z], [x, y, z]] and diameter")
        elif self.box is not None and self.diameter is not None:
            yield Problem(("diameter",), "a box has none")


def _block(value: Any) -> float | Box:
    if isinstance(value, list | tuple):
        return corners(value)
    return _MARGIN.read(value)


class CadMould(Description):
    """A block out of which all solids of the CAD files are cut.

    Attributes:
        name: of its body, or the beginning of those of its halves, `-low` and `-high`.
        box: thickness round all solids, or lowest and highest corner [m]; None: room for a shell.
        shell: distance from the solids up to which the block stays [m]; None: all of it does.
        split: axis and place of the plane between the halves [m].
        cores: bodies that are cut out of others where they overlap.
        chills: that are made for it.
        cooling: channels that are drilled through it.
        plug: body of its pieces that hang at no outer part of it, as inside an open box; None: they
            stay with it, or with the half in which more of them lies.
    """

    name: EntryName = "mould"
    box: Annotated[float | Box | None, PlainValidator(_block)] = None
    shell: Annotated[float | None, Quantity(LENGTH, above=0.0)] = None
    split: Annotated[tuple[int, float] | None, PlainValidator(_split)] = None
    cores: tuple[EntryName, ...] = Field((), max_length=_MOST_PARTS)
    chills: tuple[MouldChill, ...] = Field((), max_length=_MOST_PARTS)
    cooling: tuple[CoolingChannel, ...] = Field((), max_length=_MOST_PARTS)
    plug: EntryName | None = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a mould without size, a channel in a shell, and names that are there already."""
        if self.box is None and self.shell is None:
            yield Problem(("box",), 'missing; a block, box = "40 mm", or a shell, shell = "8 mm"')
        if self.shell is not None and self.cooling:
            yield Problem(("cooling",), "a shell has no channels; leave them or the shell out")
        if self.shell is not None and isinstance(self.box, float) and self.box <= self.shell:
            text = f"must exceed shell, {self.shell:g} m; left out it has room for it"
            yield Problem(("box",), text)
        halves = () if self.split is None else (f"{self.name}-low", f"{self.name}-high")
        names = [self.name, *halves]
        if self.plug in names:
            yield Problem(("plug",), f"is a name of the mould; {among('', names, what='names')}")
        if self.plug is not None:
            names.append(self.plug)
        for index, chill in enumerate(self.chills):
            if chill.name in names:
                text = f"is there already; {among('', names, what='names')}"
                yield Problem(("chills", index, "name"), text)
            names.append(chill.name)
