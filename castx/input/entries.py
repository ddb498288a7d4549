"""Kinds of entries of a case file: numbers, tables, choices and names."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Self, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    ModelWrapValidatorHandler,
    PlainValidator,
    ValidationError,
    create_model,
    model_validator,
)
from pydantic_core import CoreSchema, core_schema

from castx.errors import CaseError
from castx.input.json_schema import EntrySchema
from castx.input.problems import Problem, Refusal, among, refuse, show, translate
from castx.input.units import TEMPERATURE, TIME, Dimension, number
from castx.tables import Table

LONGEST_TABLE = 10_000
_LONGEST_NAME = 64
_NAME = re.compile(r"[\w+-][\w+ -]*")
_DOTTED_NAME = re.compile(r"[\w+-](?:[\w+. -]*[\w+-])?")


class Description(BaseModel):
    """A frozen part of a case that refuses unknown keys and contradictions with their path."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        arbitrary_types_allowed=True,
        defer_build=True,  # parts of a case are built with it, or not at all
    )

    @model_validator(mode="wrap")
    @classmethod
    def _refuse(cls, data: Any, handler: ModelWrapValidatorHandler[Any]) -> Any:
        try:
            description = handler(data)
        except ValidationError as error:
            raise Refusal(translate(error, cls._keys())) from None
        problems = list(description.inconsistencies())
        if problems:
            raise Refusal(problems)
        return description

    @classmethod
    def read(cls, data: Any) -> Self:
        """Return the description of a table of keys.

        Raises:
            Refusal: all problems found in it.
        """
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise Refusal(translate(error, cls._keys())) from None

    @classmethod
    def model_json_schema(cls, *arguments: Any, **settings: Any) -> dict[str, Any]:
        """Return the JSON schema of the keys; arguments as of pydantic."""
        return super().model_json_schema(*arguments, **{"schema_generator": EntrySchema} | settings)

    @classmethod
    def _keys(cls) -> list[str]:
        """Return the keys as a case file writes them."""
        return [field.alias or name for name, field in cls.model_fields.items()]

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield contradictions between values that are allowed one by one."""
        yield from ()


_Extended = TypeVar("_Extended", bound=Description)


def with_entries(
    entries: Mapping[str, tuple[Callable[..., Any], Any]],
) -> Callable[[type[_Extended]], type[_Extended]]:
    """Return a decorator that adds entries to a description.

    Args:
        entries: of each name the function that reads its value, which may ask for pydantic's
            `ValidationInfo` as well, and the default.
    """
    fields: dict[str, Any] = {
        name: (Annotated[Any, PlainValidator(read)], default)
        for name, (read, default) in entries.items()
    }

    def extended(description: type[_Extended]) -> type[_Extended]:
        return create_model(
            description.__name__,
            __base__=description,
            __module__=description.__module__,
            __doc__=description.__doc__,
            **fields,
        )

    return extended


@dataclass(frozen=True)
class Quantity:
    """A number with a unit and a range, for `Annotated[float, Quantity(...)]`.

    Args:
        dimension: physical dimension.
        above: exclusive lower bound, SI.
        least: inclusive lower bound, SI.
        below: exclusive upper bound, SI.
        most: inclusive upper bound, SI.
    """

    dimension: Dimension
    above: float = -math.inf
    least: float = -math.inf
    below: float = math.inf
    most: float = math.inf

    def read(self, value: Any) -> float:
        """Return the number in SI.

        Raises:
            CaseError: not a number of this dimension, or out of range.
        """
        result = number(value, self.dimension)
        if not (self.above < result < self.below and self.least <= result <= self.most):
            unit = f" (in {self.dimension.unit})" if self.dimension.unit else ""
            raise CaseError(f"must be {self._range()}{unit}".replace("degC", "°C"))
        return result

    def _range(self) -> str:
        bounds = [
            (self.above == 0, "positive"),
            (math.isfinite(self.above) and self.above != 0, f"above {self.above:g}"),
            (math.isfinite(self.least), f"at least {self.least:g}"),
            (math.isfinite(self.below), f"below {self.below:g}"),
            (math.isfinite(self.most), f"at most {self.most:g}"),
        ]
        return " and ".join(text for given, text in bounds if given)

    def json_schema(self) -> dict[str, Any]:
        """Return the JSON schema of the entry."""
        unit = self.dimension.shown
        said = " ".join(part for part in (self.dimension.name, f"[{unit}]" if unit else "") if part)
        bounds = self._range()
        said += f", {bounds}" if bounds else ""
        return {"type": ["number", "string"], "description": said}

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@dataclass(frozen=True)
class Tabulated:
    """A number or a table of it over another quantity, for `Annotated[Table, Tabulated(...)]`.

    Args:
        value: kind of the tabulated numbers.
        over: kind of the argument, the first column.
    """

    value: Quantity
    over: Quantity

    def read(self, value: Any) -> Table:
        """Return the table; a single number is constant.

        Raises:
            Refusal: with the offending row.
        """
        if isinstance(value, Table):
            return self._checked(value)
        if not isinstance(value, list | tuple):
            return Table.constant(self.value.read(value))
        if not 1 <= len(value) <= LONGEST_TABLE:
            raise CaseError(f"a table needs 1 to {LONGEST_TABLE} rows, got {len(value)}")
        rows = [self._row(index, row) for index, row in enumerate(value)]
        for index in range(1, len(rows)):
            if rows[index][0] <= rows[index - 1][0]:
                last = show(value[index - 1])
                raise refuse(f"the first column must increase strictly, but follows {last}", index)
        return Table.from_points(rows)

    def _row(self, index: int, row: Any) -> tuple[float, float]:
        if not isinstance(row, list | tuple) or len(row) != 2:
            text = f"a row of a table needs two numbers: {self.over.dimension.name} and a value"
            raise refuse(text, index)
        try:
            return self.over.read(row[0]), self.value.read(row[1])
        except CaseError as error:
            raise refuse(str(error), index) from None

    def _checked(self, table: Table) -> Table:
        for argument, value in zip(table.arguments, table.values, strict=True):
            self.over.read(float(argument))
            self.value.read(float(value))
        return table

    def json_schema(self) -> dict[str, Any]:
        """Return the JSON schema of the entry."""
        said = self.value.json_schema()["description"]
        over = self.over.dimension.name
        return {
            "type": ["number", "string", "array"],
            "description": f"{said}; or a table over {over}: [[{over}, value], …]",
        }

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@dataclass(frozen=True)
class Whole:
    """A whole number in a range, for `Annotated[int, Whole(...)]`.

    Args:
        least: smallest allowed.
        most: largest allowed.
    """

    least: int
    most: int

    def read(self, value: Any) -> int:
        """Return the number.

        Raises:
            CaseError: not a whole number, or outside the range.
        """
        whole = isinstance(value, int) and not isinstance(value, bool)
        if not whole or not self.least <= value <= self.most:
            raise CaseError(f"a whole number from {self.least} to {self.most} is needed")
        return int(value)

    def json_schema(self) -> dict[str, Any]:
        """Return the JSON schema of the entry."""
        return {"type": "integer", "minimum": self.least, "maximum": self.most}

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@dataclass(frozen=True)
class Choice:
    """One of some names, for `Annotated[str, Choice(...)]`.

    Args:
        names: the allowed ones.
    """

    names: tuple[str, ...]

    def read(self, value: Any) -> str:
        """Return the name.

        Raises:
            CaseError: no such name.
        """
        if isinstance(value, str) and value in self.names:
            return value
        near = value if isinstance(value, str) else ""
        raise CaseError(f"unknown; {among(near, self.names, what='allowed')}")

    def json_schema(self) -> dict[str, Any]:
        """Return the JSON schema of the entry."""
        return {"type": "string", "enum": list(self.names)}

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


@dataclass(frozen=True)
class Name:
    """A name that may also stand in file names and, without dots, in column headings.

    Args:
        dots: whether it may have inner dots, as alloys do.
    """

    dots: bool = False

    def read(self, value: Any) -> str:
        """Return the name.

        Raises:
            CaseError: not a text of letters, digits, `_`, `+`, `-`, spaces and, if allowed, dots.
        """
        if not isinstance(value, str):
            raise CaseError("a name in quotes is needed")
        allowed = _DOTTED_NAME if self.dots else _NAME
        if len(value) > _LONGEST_NAME or not allowed.fullmatch(value):
            inner = "inner dots and spaces" if self.dots else "inner spaces"
            raise CaseError(
                f"a name has 1 to {_LONGEST_NAME} letters, digits, '_', '+', '-' or {inner}"
            )
        return value

    def json_schema(self) -> dict[str, Any]:
        """Return the JSON schema of the entry."""
        return {"type": "string", "maxLength": _LONGEST_NAME}

    def __get_pydantic_core_schema__(self, _: Any, __: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)


TIMES = Quantity(TIME)
TEMPERATURES = Quantity(TEMPERATURE)
EntryName = Annotated[str, Name()]
MaterialName = Annotated[str, Name(dots=True)]
Temperature = Annotated[float, TEMPERATURES]


def over_time(dimension: Dimension, **bounds: float) -> Tabulated:
    """Return the kind of number that may be a table over time, with bounds as of `Quantity`."""
    return Tabulated(Quantity(dimension, **bounds), TIMES)


def over_temperature(dimension: Dimension, **bounds: float) -> Tabulated:
    """Return the kind of number that may be a table over temperature, with bounds as `Quantity`."""
    return Tabulated(Quantity(dimension, **bounds), TEMPERATURES)
