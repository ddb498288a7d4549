"""What a run writes: fields, checkpoints, and probes that record single points."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator

from castx.errors import CaseError
from castx.input.entries import Choice, Description, EntryName, Quantity
from castx.input.problems import Problem, among
from castx.input.units import LENGTH, TIME

FIELDS = (
    "temperature",
    "solid_fraction",
    "displacement",
    "stress",
    "von_mises",
    "plastic_strain",
    "gap",
    "contact_pressure",
    "heat_transfer_coefficient",
    "enthalpy",
    "pressure",
    "solidification_time",
    "gradient",
    "cooling_rate",
    "niyama",
)
BODY_QUANTITIES = (
    "temperature",
    "solid_fraction",
    "enthalpy",
    "displacement",
    "pressure",
    "stress",
    "von_mises",
    "plastic_strain",
)
INTERFACE_QUANTITIES = ("gap", "contact_pressure", "heat_transfer_coefficient")


def _folder(value: Any) -> Path:
    if not isinstance(value, str | Path) or not str(value).strip() or "\0" in str(value):
        raise CaseError("the path of a folder is needed, relative to the working directory")
    return Path(value)


class Output(Description):
    """Where and how often results are written.

    Attributes:
        folder: by default results/NAME-OF-THE-CASE-FILE; after loading an absolute path.
        every: time between field outputs [s]; None: only the initial and the last state.
        fields: names of the fields.
        checkpoint: time between checkpoints [s]; None: every minute of wall clock time, or less
            often if they take long.
    """

    folder: Annotated[Path, PlainValidator(_folder)] = Path("results")
    every: Annotated[float | None, Quantity(TIME, above=0.0)] = None
    fields: Annotated[tuple[Annotated[str, Choice(FIELDS)], ...], Field(max_length=len(FIELDS))] = (
        "temperature",
        "solid_fraction",
        "displacement",
        "von_mises",
    )
    checkpoint: Annotated[float | None, Quantity(TIME, above=0.0)] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield fields named twice."""
        for index, name in enumerate(self.fields):
            if name in self.fields[:index]:
                yield Problem(("fields", index), "is there already")


class Probe(Description):
    """A point of a body or of an interface whose quantities are recorded at every step.

    Attributes:
        name: in the headings of the columns.
        body: on which it lies, or None.
        interface: on which it lies as "secondary/primary", or None.
        at: coordinates [m].
        quantities: names of the recorded quantities.
    """

    name: EntryName
    body: str | None = None
    interface: str | None = None
    at: Annotated[tuple[Annotated[float, Quantity(LENGTH)], ...], Field(min_length=2, max_length=3)]
    quantities: Annotated[tuple[str, ...], Field(min_length=1, max_length=20)]

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a missing or doubled place, and quantities that are not recorded there."""
        if (self.body is None) == (self.interface is None):
            yield Problem((), 'a probe sits either on a body or on an interface: body = "casting"')
            return
        known = BODY_QUANTITIES if self.interface is None else INTERFACE_QUANTITIES
        where = "a body" if self.interface is None else "an interface"
        for index, name in enumerate(self.quantities):
            if name not in known:
                text = f"unknown quantity of {where}; {among(name, known, what='allowed')}"
                yield Problem(("quantities", index), text)
            elif name in self.quantities[:index]:
                yield Problem(("quantities", index), "is there already")
