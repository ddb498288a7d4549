"""Numerical control of a case: time steps, coupling of heat and mechanics, solvers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, PlainValidator

from castx.errors import CaseError
from castx.input.entries import Choice, Description, Quantity, Whole
from castx.input.problems import Problem, refuse
from castx.input.units import LENGTH, PURE_NUMBER, TEMPERATURE_DIFFERENCE, TIME

PetscOptions = dict[str, str | int | float | bool]

_Duration = Annotated[float, Quantity(TIME, above=0.0)]
_NUMBER = Quantity(PURE_NUMBER, above=0.0, below=1.0)
_Tolerance = Annotated[float, _NUMBER]
_MOST_STEPS = 10_000_000
_MOST_OPTIONS = 200
_LONGEST_OPTION = 200
_OPTION = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_FILE_VIEWER = re.compile(r"\w*:[^:]")


def _substeps(value: Any) -> str | int:
    if value == "automatic":
        return "automatic"
    if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= 1000:
        raise CaseError('"automatic" or a whole number from 1 to 1000 is needed')
    return int(value)


def _tolerance(value: Any) -> str | float:
    return "automatic" if value == "automatic" else _NUMBER.read(value)


def _options(value: Any) -> PetscOptions:
    """Return PETSc options, which may choose solvers but neither run code nor write files."""
    if not isinstance(value, dict) or len(value) > _MOST_OPTIONS:
        raise CaseError('a table of PETSc options is needed: { ksp_rtol = 1e-8, pc_type = "gamg" }')
    for name, setting in value.items():
        if not isinstance(name, str) or not _OPTION.fullmatch(name):
            raise refuse("a PETSc option is named without its leading dash and prefix", name)
        if not isinstance(setting, str | int | float):
            raise refuse("a PETSc option is a text, a number, true or false", name)
        text = str(setting)
        if len(text) > _LONGEST_OPTION or not text.isprintable():
            raise refuse(f"at most {_LONGEST_OPTION} printable characters are allowed", name)
        if "python" in name or text in ("python", "shell"):
            raise refuse("options that run user code are not allowed in a case file", name)
        if _FILE_VIEWER.match(text):
            raise refuse("options that write files are not allowed in a case file", name)
    return dict(value)


class StepTolerance(Description):
    """Errors by the steps that a run may have; a quantity without one may have any.

    Attributes:
        temperature: of any node, by all steps so far [K].
        gap: of any pair, by a step [m].
        strain: of the equivalent viscoplastic strain, root mean square over what is solid of any
            body, by a step.
    """

    temperature: Annotated[float, Quantity(TEMPERATURE_DIFFERENCE, above=0.0)] | None = None
    gap: Annotated[float, Quantity(LENGTH, above=0.0)] | None = None
    strain: Annotated[float, Quantity(PURE_NUMBER, above=0.0, below=1.0)] | None = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a tolerance of nothing."""
        if self.temperature is None and self.gap is None and self.strain is None:
            text = "at least one of temperature, gap and strain is needed"
            yield Problem((), text)


class Time(Description):
    """Span and steps of a run.

    Attributes:
        end: of the run, or where cycles go on longer of the first one [s].
        largest_step: by default a twentieth of the end [s].
        first_step: None: a thousandth of the end at most, the largest step, and as long as the
            fastest node takes for the wanted change of temperature at first [s].
        smallest_step: None: a thousandth of the first one [s].
        temperature_change: wanted in a step, in any node [K].
        solid_fraction_change: wanted in a step, of the mean over any body.
        skin_change: wanted in a step, of the metal that bears at its wall, in the mean over any
            interface.
        reject_above: multiple of a wanted change above which a step is taken again, smaller.
        fixed_step: length of all steps in place of adaptive ones [s].
        heat_substeps: heat steps within one mechanical step.
        tolerance: of the errors by the steps. With one, wanted changes that are not given bound no
            step.
    """

    end: _Duration
    largest_step: _Duration = Field(default_factory=lambda time: time.get("end", 1.0) / 20.0)
    first_step: _Duration | None = None
    smallest_step: _Duration | None = None
    temperature_change: Annotated[float, Quantity(TEMPERATURE_DIFFERENCE, above=0.0)] = 20.0
    solid_fraction_change: Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=1.0)] = 0.04
    skin_change: Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=1.0)] = 0.1
    reject_above: Annotated[float, Quantity(PURE_NUMBER, least=1.0)] = 2.0
    fixed_step: _Duration | None = None
    heat_substeps: Annotated[str | int, PlainValidator(_substeps)] = "automatic"
    tolerance: StepTolerance | None = None

    def bounds(self, key: str) -> bool:
        """Return whether a key bounds steps: with a tolerance only changes that are given do."""
        unbounded = self.tolerance is not None and key not in self.model_fields_set
        return not (unbounded and key.endswith("_change"))

    def wanted(self, key: str) -> float:
        """Return the wanted change of a key; infinite: it bounds no steps."""
        value: float = getattr(self, key)
        return value if self.bounds(key) else math.inf

    @property
    def usual_first_step(self) -> float:
        """The longest first step that castx chooses [s]."""
        return min(1e-3 * self.end, self.largest_step)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield steps that exceed larger ones, and far too many steps."""
        if self.first_step is not None and self.first_step > self.largest_step:
            origin = "" if "largest_step" in self.model_fields_set else ", by default end/20"
            text = f"must not exceed largest_step, {self.largest_step:g} s{origin}"
            yield Problem(("first_step",), text)
        first = self.usual_first_step if self.first_step is None else self.first_step
        if self.smallest_step is not None and self.smallest_step > first:
            yield Problem(("smallest_step",), f"must not exceed first_step, {first:g} s")
        if self.tolerance is not None and self.fixed_step is not None:
            yield Problem(("tolerance",), "chooses the steps: leave it or fixed_step out")
        for key in ("largest_step", "fixed_step"):
            step = getattr(self, key)
            if step is not None and self.end / step > _MOST_STEPS:
                yield Problem((key,), f"makes more than {_MOST_STEPS} steps up to {self.end:g} s")


class Coupling(Description):
    """Coupling of heat and mechanics within a step.

    Attributes:
        scheme: which of the two are solved, and in what order.
        tolerance: relative change of the thermal resistance of every pair between passes.
        passes: most passes of a step.
    """

    scheme: Annotated[
        str, Choice(("thermal", "mechanical", "one-way", "staggered", "iterated"))
    ] = "iterated"
    tolerance: _Tolerance = 1e-3
    passes: Annotated[int, Whole(1, 10_000)] = 40


class Solver(Description):
    """Linear and nonlinear solvers.

    Attributes:
        linear: "direct", "iterative", or by the size of the problem.
        heat: PETSc options of the heat problem, by their own names.
        mechanics: those of the mechanical problem.
        contact: those of the contact problem.
        heat_tolerance: of the heat balance, relative; "automatic": as fine as the passes need.
        mechanics_tolerance: of the balance of forces, relative.
    """

    linear: Annotated[str, Choice(("automatic", "direct", "iterative"))] = "automatic"
    heat: Annotated[PetscOptions, PlainValidator(_options)] = Field({})
    mechanics: Annotated[PetscOptions, PlainValidator(_options)] = Field({})
    contact: Annotated[PetscOptions, PlainValidator(_options)] = Field({})
    heat_tolerance: Annotated[str | float, PlainValidator(_tolerance)] = "automatic"
    mechanics_tolerance: _Tolerance = 3e-4
