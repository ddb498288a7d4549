"""Unknowns of a study as numbers of a fit, and back as changes of the case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.foundry.identification.fit import Unknown
from castx.foundry.identification.smoothness import second_differences
from castx.input.coordinates import AXES
from castx.input.overrides import value_at
from castx.input.problems import show
from castx.input.units import LENGTH
from castx.input.variation import ARGUMENTS
from castx.studies.asked.amounts import Amount, amount, in_unit
from castx.studies.asked.known import refuse_elsewhere
from castx.studies.asked.units_of_case import unit_at
from castx.studies.asked.unknowns import LINEAR, LOG, SoughtNumber
from castx.studies.runs.runner import Changes, changes_as_overrides
from castx.tables import Table

BETWEEN = 8
"""Pieces of a table between two knots, so that it is linear in ln."""
DIGITS = 9
"""Of the values of a table."""
OF_LN = 0.01
"""Usual difference of a logarithm."""
UNIT_OF_KNOTS = {"time": 1.0, "gap": 1e-5, "pressure": 1e6}
"""Arguments x enter smoothness by ln(1 + x/x_1) with this x_1 [SI]; temperatures and
places by their span."""


@dataclass(frozen=True, eq=False)
class SoughtValues:
    """An unknown with the numbers of the case.

    Attributes:
        asked: its description.
        unit: of its values as the study writes them, "" if plain.
        start: of its knots, in the unit, (knots,); of a number (1,).
        present: what the case has there; None: nothing.
        plain_unit: of SI, for values that are written without one.
    """

    asked: SoughtNumber
    unit: str
    start: FloatArray
    present: Any
    plain_unit: str = ""

    @classmethod
    def of(cls, asked: SoughtNumber, content: Mapping[str, Any]) -> SoughtValues:
        """Return an unknown of a case.

        Args:
            asked: its description.
            content: keys and values of the case.

        Raises:
            CaseError: the case has no number to begin with.
        """
        present, plain = value_at(content, asked.of), unit_at(content, asked.of)
        knots = [one.value for one in asked.knots or ()] or [0.0]
        if asked.start is not None:
            values = [one.value for one in asked.start]
            unit = asked.given_unit or ""
            full = values if len(values) == len(knots) else values * len(knots)
            return cls(asked, unit, np.array(full), present, plain)
        if present is None:
            raise CaseError(
                f"[identify] {asked.name}: the case has nothing at {asked.of}; correct the path, "
                "or give a start"
            )
        unit, values = _values_there(asked, present, knots)
        _refuse_beyond_bounds(asked, unit, values)
        return cls(asked, unit, np.array(values), present, plain)

    @property
    def names(self) -> list[str]:
        """Names of its numbers."""
        if not self.asked.is_table:
            return [self.asked.name]
        unit = self.unit_of_knots
        knots = (f"{one.value:g} {unit}".strip() for one in self.asked.knots or ())
        return [f"{self.asked.name} at {knot}" for knot in knots]

    @property
    def knots(self) -> FloatArray:
        """Arguments of a table, in their unit, (knots,)."""
        return np.array([one.value for one in self.asked.knots or ()])

    @property
    def shown_unit(self) -> str:
        """Unit of its values as they are shown."""
        return self.unit or self.plain_unit

    @property
    def unit_of_knots(self) -> str:
        """Unit of the arguments of a table, that of SI where none is written."""
        (unit,) = {one.unit for one in self.asked.knots or ()}
        over = str(self.asked.over)
        plain = LENGTH if over in AXES else ARGUMENTS[over].dimension
        return unit or plain.shown

    @property
    def abscissa(self) -> str:
        """Label of the arguments of a table, with their unit."""
        return f"{self.asked.over} [{self.unit_of_knots}]"

    def unknowns(self) -> list[Unknown]:
        """Return its numbers as a fit takes them."""
        asked, positive = self.asked, self.asked.scale == LOG
        ends = {
            "low": -np.inf if asked.low is None else asked.low.value,
            "high": np.inf if asked.high is None else asked.high.value,
        }
        return [
            Unknown(
                name, float(start), asked.difference or self._difference(float(start)),
                asked.deviation or np.inf, positive, **ends,
            )
            for name, start in zip(self.names, self.start, strict=True)
        ]  # fmt: skip

    def _difference(self, start: float) -> float:
        if self.asked.scale == LOG:
            return OF_LN
        if self.asked.deviation is not None:
            return 0.1 * self.asked.deviation
        return 0.01 * abs(start) or 0.01

    def change(self, values: Mapping[str, float]) -> Any:
        """Return the value for the case file from the values of its numbers."""
        found = np.array([values[name] for name in self.names])
        if not self.asked.is_table:
            return Amount(0.0, self.unit).written(float(found[0]))
        at = self.fine_knots()
        argument = (self.asked.knots or ())[0]
        curve = self.curve(found, at)
        rows = [
            [argument.written(float(x)), Amount(0.0, self.unit).written(float(f"{y:.{DIGITS}g}"))]
            for x, y in zip(at, curve, strict=True)
        ]
        if self.asked.over in AXES:
            return {"along": self.asked.over, "table": rows}
        if not self.asked.of.startswith("interfaces"):
            return rows
        kept = self.present if isinstance(self.present, Mapping) else {}
        return {**kept, "over": self.asked.over, "table": rows}

    def fine_knots(self) -> FloatArray:
        """Return the arguments of the table in the case, (points,)."""
        pieces = [np.linspace(a, b, BETWEEN, endpoint=False) for a, b in pairwise(self.knots)]
        return np.concatenate([*pieces, self.knots[-1:]])

    def curve(self, values: FloatArray, at: FloatArray) -> FloatArray:
        """Return the table between its knots, linear in ln or in the number itself."""
        if self.asked.scale == LOG:
            return np.asarray(np.exp(np.interp(at, self.knots, np.log(values))))
        return np.asarray(np.interp(at, self.knots, values))

    def smoothness(self) -> FloatArray | None:
        """Return S/γ of its numbers, (rows, numbers); None of what may be rough."""
        if self.asked.smoothness is None:
            return None
        unit = UNIT_OF_KNOTS.get(str(self.asked.over), float(np.ptp(self.knots)))
        differences = second_differences((self.knots - self.knots[0]) / unit)
        return np.asarray(differences / self.asked.smoothness)


def _values_there(
    asked: SoughtNumber, present: Any, knots: Sequence[float]
) -> tuple[str, list[float]]:
    """Return unit and values that the case has at the knots."""
    try:
        rows = present.get("table") if isinstance(present, Mapping) else present
        if not isinstance(rows, list):
            one = amount(rows)
            unit = one.unit if asked.given_unit is None else asked.given_unit
            return unit, [in_unit(one, unit)] * len(knots)
        pairs = [(amount(row[0]), amount(row[1])) for row in rows]
        unit = pairs[0][1].unit if asked.given_unit is None else asked.given_unit
        over = (asked.knots or (Amount(0.0),))[0].unit
        table = Table.from_points([(in_unit(x, over), in_unit(y, unit)) for x, y in pairs])
        if not asked.is_table:
            raise CaseError("the case has a table there: say over and knots, or give a start")
        return unit, [float(y) for y in table(np.array(knots))]
    except CaseError as error:
        raise CaseError(
            f"[identify] {asked.name}: the case has {asked.of} = {show(present)}: {error}"
        ) from None


def _refuse_beyond_bounds(asked: SoughtNumber, unit: str, values: Sequence[float]) -> None:
    """Refuse values of the case at which a fit cannot begin."""
    low = -np.inf if asked.low is None else asked.low.value
    high = np.inf if asked.high is None else asked.high.value
    for value in values:
        said = f"[identify] {asked.name}: the case has {asked.of} = {value:g} {unit}".rstrip()
        if asked.scale == LOG and value <= 0.0:
            raise CaseError(
                f'{said}, which has no logarithm: say scale = "{LINEAR}", or give a positive start'
            )
        if not low < value < high:
            beyond = f"not above low = {low:g}" if value <= low else f"not below high = {high:g}"
            raise CaseError(f"{said}, {beyond}: give a start between them, or other bounds")


@dataclass(frozen=True, eq=False)
class Parameters:
    """All unknowns of the case.

    Attributes:
        sought: them.
    """

    sought: Sequence[SoughtValues]

    @classmethod
    def of(cls, asked: Sequence[SoughtNumber], content: Mapping[str, Any]) -> Parameters:
        """Return the unknowns of a case; raises as `SoughtValues.of`."""
        return cls([SoughtValues.of(one, content) for one in asked])

    def refuse_unusable(
        self, case_file: Path, overrides: Sequence[str], content: Mapping[str, Any]
    ) -> None:
        """Refuse unknowns that the case does not take with their start.

        Args:
            case_file: the case.
            overrides: values that replace those of the file.
            content: keys and values of the case.

        Raises:
            CaseError: with path, value and what the case asks for.
        """
        for one in self.sought:
            start = {one.asked.of: one.change(dict(zip(one.names, one.start, strict=True)))}
            try:
                refuse_elsewhere(content, one.asked.of)
                load_case(case_file, [*overrides, *changes_as_overrides(start)])
            except CaseError as error:
                raise CaseError(f"[identify] {one.asked.name}: {error}") from None

    def unknowns(self) -> list[Unknown]:
        """Return all numbers as a fit takes them."""
        return [unknown for one in self.sought for unknown in one.unknowns()]

    def changes(self, values: Mapping[str, float]) -> Changes:
        """Return the changes of the case for the values of all numbers."""
        return {one.asked.of: one.change(values) for one in self.sought}

    def smoothness(self, numbers: int) -> FloatArray | None:
        """Return S/γ of all numbers of the fit, of which those of the case come first.

        Args:
            numbers: of the fit, (rows, numbers) is the shape of the result.
        """
        rows, first = [], 0
        for one in self.sought:
            part = one.smoothness()
            if part is not None:
                whole = np.zeros((len(part), numbers))
                whole[:, first : first + part.shape[1]] = part
                rows.append(whole)
            first += len(one.names)
        return np.asarray(np.vstack(rows)) if rows else None
