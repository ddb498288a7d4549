"""Output of a run: folder, fields, probes, measured curves for comparison."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, StrictStr

from castx.case.boundaries import surface_names
from castx.case.fields.declaration import FieldPlace
from castx.case.fields.registry import output_fields, probed
from castx.errors import CaseError
from castx.input.entries import (
    TEMPERATURES,
    Choice,
    Description,
    EntryName,
    MaterialName,
    Quantity,
    Temperature,
)
from castx.input.problems import Problem, among, refuse
from castx.input.units import (
    LENGTH,
    PURE_NUMBER,
    TIME,
    Dimension,
    number,
)

FIELDS = tuple(output_fields())
BODY_QUANTITIES = probed(FieldPlace.NODE, FieldPlace.CELL)
INTERFACE_QUANTITIES = probed(FieldPlace.PAIR)
DIMENSIONS = {
    name: field.dimension for name, field in output_fields().items() if field.dimension is not None
}
"""Of the quantities that probes record."""
FORMATS = ("vtkhdf", "vtu")
"""Formats of the files of fields."""


def _path(value: Any, needed: str) -> Path:
    if not isinstance(value, str | Path) or not str(value).strip() or "\0" in str(value):
        raise CaseError(f"the path of {needed}")
    return Path(value)


_FOLDER = partial(_path, needed="a folder is needed, relative to the working directory")
_TABLE = partial(_path, needed="a table is needed, relative to the case file")


class Output(Description):
    """Where and how often results are written.

    Attributes:
        folder: by default results/NAME-OF-THE-CASE-FILE; after loading an absolute path.
        every: time between fields that are written beside those at events [s]; None: events alone.
        fields: names of the fields.
        format: of their files: one growing VTKHDF file a body, or a VTU file for each body, rank
            and moment; a run goes on in the format in which it began.
        checkpoint: time between checkpoints [s]; None: every minute of wall clock time, or less
            often if they take long.
    """

    folder: Annotated[Path, PlainValidator(_FOLDER)] = Path("results")
    every: Annotated[float | None, Quantity(TIME, above=0.0)] = None
    fields: Annotated[tuple[Annotated[str, Choice(FIELDS)], ...], Field(max_length=len(FIELDS))] = (
        "temperature",
        "solid_fraction",
        "displacement",
        "von_mises",
        "gap",
        "solidification_time",
    )
    format: Annotated[str, Choice(FORMATS)] = "vtkhdf"
    checkpoint: Annotated[float | None, Quantity(TIME, above=0.0)] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield fields named twice."""
        for index, name in enumerate(self.fields):
            if name in self.fields[:index]:
                yield Problem(("fields", index), "is there already")


_FRACTION = Quantity(PURE_NUMBER, least=0.0, most=1.0)


@dataclass(frozen=True)
class FrontPlace:
    """The surface at whose passing gradient and cooling rate are taken; one of both is given.

    Attributes:
        fraction: solid fraction there.
        temperature: there [°C].
    """

    fraction: float | None = None
    temperature: float | None = None

    @property
    def text(self) -> str:
        """The place for people, as "f_s = 0.9"."""
        if self.fraction is not None:
            return f"f_s = {self.fraction!r}"
        return f"{self.temperature!r} °C"


def _front(value: Any) -> FrontPlace:
    if isinstance(value, FrontPlace):
        return value
    if not isinstance(value, dict):
        return FrontPlace(fraction=_FRACTION.read(value))
    if set(value) != {"temperature"}:
        raise CaseError('a solid fraction is needed, or { temperature = "565 degC" }')
    try:
        return FrontPlace(temperature=TEMPERATURES.read(value["temperature"]))
    except CaseError as error:
        raise refuse(str(error), "temperature") from None


MODULUS_CONSTANT = Dimension("Chvorinov's constant", "s/m^2", ("s/m^2", "s/cm^2", "min/cm^2"))


class ModulusMould(Description):
    """The mould whose heat makes Chvorinov's constant.

    Attributes:
        material: of the database or of the case.
        temperature: at the start [°C].
    """

    material: MaterialName
    temperature: Temperature


class Foundry(Description):
    """Settings of the foundry quantities.

    Attributes:
        at: solid fraction, or temperature, at which gradient, cooling rate and front speed are.
        passing_times: solid fractions whose passing the field `passing_times` shows.
        modulus_constant: Chvorinov's constant [s/m²].
        modulus_mould: or the mould from which it follows.
        pool_limit: solid fraction below which liquid belongs to a pool; None: the coherency of the
            material, 0.7 where it has none.
        feeders: surfaces "body/surface" that feed; None: all free surfaces.
        ejection_friction: coefficient of friction from which the forces to draw bodies apart are
            estimated at each interface; None: they are not.
        flat: surfaces "body/surface" whose flatness is measured at the ends of stages.
        round: those whose roundness is, in plane models.
        porosity_limit: pore fraction below which a place counts as fed.
        opening_gap: gap beyond which a pair of an interface counts as open [m].
        mass_feeding_limit: solid fraction below which metal sinks to feed; None: as for pools.
    """

    at: Annotated[FrontPlace, PlainValidator(_front)] = FrontPlace(fraction=0.9)
    passing_times: Annotated[
        tuple[Annotated[float, _FRACTION], ...], Field(min_length=1, max_length=20)
    ] = (0.0, 0.5, 1.0)
    modulus_constant: Annotated[float | None, Quantity(MODULUS_CONSTANT, above=0.0)] = None
    modulus_mould: ModulusMould | None = None
    pool_limit: Annotated[float | None, Quantity(PURE_NUMBER, above=0.0, most=1.0)] = None
    feeders: Annotated[tuple[str, ...] | None, PlainValidator(surface_names)] = None
    ejection_friction: Annotated[float | None, Quantity(PURE_NUMBER, least=0.0)] = None
    flat: Annotated[tuple[str, ...], PlainValidator(surface_names)] = ()
    round: Annotated[tuple[str, ...], PlainValidator(surface_names)] = ()
    porosity_limit: Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=1.0)] = 5e-4
    opening_gap: Annotated[float, Quantity(LENGTH, above=0.0)] = 1e-6
    mass_feeding_limit: Annotated[float | None, Quantity(PURE_NUMBER, above=0.0, most=1.0)] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield fractions named twice, and two ways to the constant of the modulus."""
        for index, fraction in enumerate(self.passing_times):
            if fraction in self.passing_times[:index]:
                yield Problem(("passing_times", index), "is there already")
        if self.modulus_constant is not None and self.modulus_mould is not None:
            text = "both say the constant of the modulus; leave one out"
            yield Problem(("modulus_mould",), f"modulus_constant and modulus_mould {text}")


class Probe(Description):
    """A point of a body or of an interface whose quantities are recorded at every step.

    Attributes:
        name: in the headings of the columns.
        body: on which it lies, or None.
        interface: on which it lies as "secondary/primary", or None.
        below: interface or surface of the body under which it lies; None: it lies where `at` says.
        depth: distance from there into the body, along the normal [m].
        at: coordinates [m].
        quantities: names of the recorded quantities.
    """

    name: EntryName
    body: str | None = None
    interface: str | None = None
    below: str | None = None
    depth: Annotated[float, Quantity(LENGTH, least=0.0)] = 0.0
    at: Annotated[tuple[Annotated[float, Quantity(LENGTH)], ...], Field(min_length=2, max_length=3)]
    quantities: Annotated[tuple[str, ...], Field(min_length=1, max_length=20)]

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a missing or doubled place, and quantities that are not recorded there."""
        if (self.body is None) == (self.interface is None):
            yield Problem((), 'a probe sits either on a body or on an interface: body = "casting"')
            return
        if self.below is not None and self.body is None:
            yield Problem(("below",), 'needs the body into which the depth goes: body = "mould"')
        if self.below is None and self.depth > 0.0:
            text = 'needs the surface from which it is measured: below = "casting/mould"'
            yield Problem(("depth",), text)
        known = BODY_QUANTITIES if self.interface is None else INTERFACE_QUANTITIES
        where = "a body" if self.interface is None else "an interface"
        for index, name in enumerate(self.quantities):
            if name not in known:
                text = f"unknown quantity of {where}; {among(name, known, what='allowed')}"
                yield Problem(("quantities", index), text)
            elif name in self.quantities[:index]:
                yield Problem(("quantities", index), "is there already")


_Title = Annotated[StrictStr, Field(min_length=1, max_length=200)]
_UnitName = Annotated[StrictStr, Field(max_length=40)]


class Measurement(Description):
    """A measured curve, for comparison with the curve of a probe in the report.

    Attributes:
        of: column of probes.csv, PROBE.QUANTITY or PROBE.QUANTITY.PART.
        file: table of a logger, whose first line names its columns; after loading an absolute path.
        column: of the file; None: the one called as `of`.
        unit: of the numbers there; empty: that of the quantity in SI, °C of temperatures.
        time: column of the times.
        time_unit: of these; empty: seconds.
        start: time of the logger when the run begins [s].
    """

    of: _Title
    file: Annotated[Path, PlainValidator(_TABLE)]
    column: _Title | None = None
    unit: _UnitName = ""
    time: _Title = "time"
    time_unit: _UnitName = ""
    start: Annotated[float, Quantity(TIME)] = 0.0

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield something else than a quantity of a probe, and units of something else."""
        quantity = self.of.partition(".")[2].partition(".")[0]
        if quantity not in DIMENSIONS:
            known = among(quantity, list(DIMENSIONS), what="quantities of probes")
            yield Problem(("of",), f'a column of probes.csv is needed, "PROBE.QUANTITY"; {known}')
            return
        for key, dimension in (("unit", DIMENSIONS[quantity]), ("time_unit", TIME)):
            unit = getattr(self, key)
            try:
                if unit:
                    number(f"300 {unit}", dimension)
            except CaseError as error:
                yield Problem((key,), str(error))

    def relative_to(self, folder: Path) -> Measurement:
        """Return the same with an absolute path of its file, given relative to a folder."""
        return self.model_copy(update={"file": folder / self.file})
