"""A folder of an experiment: digits with source and uncertainty, the case, and missing data.

`experiment.toml` says what was measured, `case.toml` is the case with its [[measurements]]. A digit
that nobody could read is a text that begins with "missing" in either of them; an experiment with
such texts is refused with all of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, PlainValidator, StrictStr

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.entries import Choice, Description, Whole
from castx.input.problems import KeyPath, Problem, Refusal, among, dotted, summary
from castx.input.toml_text import parse_toml
from castx.results.files.run_tables import TIME, RunTables
from castx.results.states.quantities import UNITS
from castx.studies.asked.inputs import VariedInput

EXPERIMENT, CASE = "experiment.toml", "case.toml"
MISSING = "missing"
NOT_STATED = "not stated"
MOMENTS: Mapping[str, Callable[[FloatArray], float]] = {
    "end": lambda values: float(values[-1]),
    "largest": lambda values: float(values.max()),
    "smallest": lambda values: float(values.min()),
}
"""Numbers of a curve."""
MOST_DRAWS = 10_000
_LARGEST_FILE = 4_000_000  # bytes


def _digit(value: Any) -> float | str:
    if isinstance(value, str) and value.startswith(MISSING):
        return value
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    raise CaseError('a number is needed, or "missing: and why"')


def _uncertainty(value: Any) -> float | str:
    if value == NOT_STATED:
        return NOT_STATED
    if isinstance(value, int | float) and not isinstance(value, bool) and value > 0:
        return float(value)
    raise CaseError(f'a positive number is needed, or "{NOT_STATED}"')


def _number(value: Any) -> float:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    raise CaseError("a number is needed")


_Text = Annotated[StrictStr, Field(min_length=1)]
_Column = Annotated[StrictStr, Field(pattern=r"^[^.]+\.[^.]+")]
_Uncertainty = Annotated[float | str, PlainValidator(_uncertainty)]


class Digit(Description):
    """A number of the experiment.

    Attributes:
        name: what it is.
        value: in the unit, or a text that begins with "missing".
        unit: of the number.
        uncertainty: in the unit, or "not stated".
    """

    name: _Text
    value: Annotated[float | str, PlainValidator(_digit)]
    unit: StrictStr = ""
    uncertainty: _Uncertainty = NOT_STATED


class Ratio(Description):
    """A number without dimension that needs no dimensions of the casting.

    Attributes:
        name: what it is.
        of: name of the digit above the line.
        over: name of that below.
        model: what the model says of it, if it can without what is missing.
        because: why it can, or why it cannot.
    """

    name: _Text
    of: _Text
    over: _Text
    model: float | None = None
    because: _Text


class MeasuredCurve(Description):
    """Metadata of a measured curve of the case.

    Attributes:
        of: column of probes.csv, as in the [[measurements]] of the case.
        uncertainty: in SI units, or "not stated".
        source: where the curve was read.
    """

    of: _Text
    uncertainty: _Uncertainty
    source: _Text


class AssumedRange(VariedInput):
    """A number of the case that nobody could read, and the range over which it is varied.

    Attributes:
        because: why it should lie there; no digit of the experiment.
    """

    because: _Text

    @property
    def text(self) -> str:
        """The range in words."""
        first, last = (f"{self.quantile(share):.4g}" for share in (0.0, 1.0))
        return f"{first} to {last} {self.unit}".strip()


class Fall(Description):
    """The moment at which a curve has fallen to a value.

    Attributes:
        column: of probes.csv or history.csv.
        to: the value, in the unit of the column.
    """

    column: _Column
    to: Annotated[float, PlainValidator(_number)]

    def moment(self, time: FloatArray, values: FloatArray) -> float:
        """Return when a curve, linear between its (steps,), comes from above for good [s].

        Raises:
            CaseError: it ends above the value.
        """
        above = np.flatnonzero(values > self.to)
        if not above.size:
            return float(time[0])
        last = int(above[-1])
        if last + 1 == len(values):
            raise CaseError(
                f"{self.column} ends at {values[-1]:.4g}, above {self.to:g}: an answer needs it "
                "to fall to that; let the case end later"
            )
        share = (values[last] - self.to) / (values[last] - values[last + 1])
        return float(time[last] + share * (time[last + 1] - time[last]))


class MeasuredAnswer(Description):
    """A measured digit, and the number of a run that answers it.

    Attributes:
        digit: its name.
        column: of probes.csv or history.csv.
        moment: "end", "largest" or "smallest" of the curve.
        when: a moment in place of these: another curve has fallen to a value.
        opposite: whether what was measured counts the other way round.
    """

    digit: _Text
    column: _Column
    moment: Annotated[str, Choice(tuple(MOMENTS))] = "end"
    when: Fall | None = None
    opposite: bool = False

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield two moments for one number."""
        if self.when is not None and "moment" in self.model_fields_set:
            yield Problem(("when",), "says the moment, as `moment` does; leave one out")

    def of_run(self, run: RunTables) -> float:
        """Return the number of a run, in the unit of its column.

        Raises:
            CaseError: the run has no such column, or the moment never comes.
        """
        column = column_of(run, self.column)
        values = 0.0 - column if self.opposite else column
        if self.when is None:
            return MOMENTS[self.moment](values)
        time = run.history[TIME]
        return float(
            np.interp(self.when.moment(time, column_of(run, self.when.column)), time, values)
        )

    def unit_of(self, run: RunTables) -> str:
        """Return the unit of its column."""
        if self.column in run.probes:
            return UNITS[self.column.split(".")[1]]
        return run.history_unit(self.column)


def column_of(run: RunTables, name: str) -> FloatArray:
    """Return a column of probes.csv or history.csv, (steps + 1,).

    Raises:
        CaseError: neither has it; with those of history.csv.
    """
    return run.probes[name] if name in run.probes else run.history[name]


class Facts(Description):
    """The content of experiment.toml.

    Attributes:
        title: in a line.
        source: author, year, place, and how it was read.
        summary: what was done.
        digits: numbers of the experiment.
        ratios: of these numbers.
        curves: what is known of measured curves.
        ranges: over which missing numbers of the case are varied.
        draws: runs of these.
        answers: digits beside which numbers of these runs are laid.
    """

    title: _Text
    source: _Text
    summary: _Text
    digits: tuple[Digit, ...] = ()
    ratios: tuple[Ratio, ...] = ()
    curves: tuple[MeasuredCurve, ...] = ()
    ranges: tuple[AssumedRange, ...] = ()
    draws: Annotated[int, Whole(2, MOST_DRAWS)] = 16
    answers: tuple[MeasuredAnswer, ...] = ()

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield ratios and answers of digits that are not there, and ranges given twice."""
        names = [digit.name for digit in self.digits]
        for index, answer in enumerate(self.answers):
            if answer.digit not in names:
                text = f"there is no such digit; {among(answer.digit, names, what='digits')}"
                yield Problem(("answers", index, "digit"), text)
        varied = [one.of for one in self.ranges]
        for index, of in enumerate(varied):
            if of in varied[:index]:
                yield Problem(("ranges", index, "of"), "has a range already; leave one out")
        for index, ratio in enumerate(self.ratios):
            for key, name in (("of", ratio.of), ("over", ratio.over)):
                if name not in names:
                    text = f"there is no such digit; {among(name, names, what='digits')}"
                    yield Problem(("ratios", index, key), text)


@dataclass(frozen=True)
class Experiment:
    """An experiment as its folder has it.

    Attributes:
        folder: where its files are.
        facts: what was measured.
        case: content of the case file.
    """

    folder: Path
    facts: Facts
    case: Mapping[str, Any]

    @property
    def name(self) -> str:
        """Name of the folder."""
        return self.folder.name

    @property
    def missing(self) -> tuple[str, ...]:
        """Missing data: name of the digit or key of the case, and why."""
        digits = [(d.name, d.value) for d in self.facts.digits if isinstance(d.value, str)]
        keys = [(f"{CASE}: {dotted(path)}", text) for path, text in missing_texts(self.case)]
        return tuple(
            f"{what}: {text.removeprefix(MISSING).lstrip(': ') or 'not known'}"
            for what, text in (*digits, *keys)
        )

    def ratio(self, ratio: Ratio) -> float | None:
        """Return the measured value of a ratio; None if a digit of it is missing."""
        values = {digit.name: digit.value for digit in self.facts.digits}
        above, below = values[ratio.of], values[ratio.over]
        if isinstance(above, str) or isinstance(below, str):
            return None
        return above / below

    def refuse_incomplete(self) -> None:
        """Refuse to compare a model with digits that nobody knows.

        Raises:
            CaseError: something is missing, with all of it; or nothing was measured.
        """
        if self.missing:
            lines = "\n  ".join(self.missing)
            raise CaseError(
                f"{self.folder}: {len(self.missing)} digits are missing, and none is invented; "
                f"write them into {EXPERIMENT} and {CASE}:\n  {lines}"
            )
        if not self.case.get("measurements"):
            raise CaseError(f"{self.folder / CASE}: there are no [[measurements]] to compare with")


def missing_texts(data: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, str]]:
    """Yield the path and text of every value that begins with "missing".

    Args:
        data: content of a file.
        path: that leads to it.
    """
    if isinstance(data, str) and data.startswith(MISSING):
        yield path, data
    elif isinstance(data, Mapping):
        for key, value in data.items():
            yield from missing_texts(value, (*path, key))
    elif isinstance(data, Sequence) and not isinstance(data, str):
        for index, value in enumerate(data):
            yield from missing_texts(value, (*path, index))


def read_experiment(folder: Path) -> Experiment:
    """Return the experiment of a folder.

    Raises:
        CaseError: a file cannot be read or says something else; with all problems.
    """
    data = _read(folder / EXPERIMENT)
    try:
        facts = Facts.read(data)
    except Refusal as refusal:
        raise CaseError(summary(str(folder / EXPERIMENT), refusal.problems, data)) from None
    return Experiment(folder, facts, _read(folder / CASE))


def _read(path: Path) -> dict[str, Any]:
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST_FILE)
    except OSError as error:
        raise CaseError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        return parse_toml(content.decode())
    except (CaseError, ValueError) as error:
        raise CaseError(f"{path}: {error}") from None


def experiments(root: Path) -> list[Experiment]:
    """Return all experiments of a folder, by their names.

    Raises:
        CaseError: there is none.
    """
    found = sorted(path.parent for path in root.glob(f"*/{EXPERIMENT}"))
    if not found:
        text = "name the folder that holds them with --folder"
        raise CaseError(f"{root}: there are no experiments, folders with {EXPERIMENT}; {text}")
    return [read_experiment(folder) for folder in found]


def chosen(root: Path, name: str) -> Experiment:
    """Return an experiment of a folder by its name.

    Raises:
        CaseError: it is not there.
    """
    known = {experiment.name: experiment for experiment in experiments(root)}
    if name not in known:
        raise CaseError(f"{root}: there is no experiment {name!r}; {among(name, list(known))}")
    return known[name]
