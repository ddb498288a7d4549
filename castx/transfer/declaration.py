"""Declaration of a gap heat law by its file: name, keys, formula, source and construction."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Generic, Literal, Self, TypeVar, cast

from castx.input.entries import Quantity, Tabulated
from castx.input.placed import PlacedOverTime
from castx.input.problems import Problem
from castx.input.registry import refuse_incomplete
from castx.input.variation import Variation, Varying
from castx.transfer.conductance import ConductionLaw

Choose = Callable[[float, float], float]
"""From the ends of a range to a number in it."""

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)


@dataclass(frozen=True, eq=False)
class HeatKey(Generic[T_co]):
    """A key of the case file that describes the heat transfer at an interface or a surface.

    Attributes:
        name: as a case file writes it.
        meaning: what it is, in a few words.
        entry: how it is read: a number, a number or table, or the type of a field.
        usual: what castings have, as a case file gives it [SI], with a pair (low, high) in place of
            each number that has a range.
        default: without the key.
        over: quantities over which its table may go in a law; (): all those of its entry.
    """

    name: str = ""
    meaning: str = ""
    entry: Quantity | Varying | object = None
    usual: object = None
    default: T_co | None = None
    over: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Refuse a key that is not declared completely.

        Raises:
            TypeError: with what is missing.
        """
        what = f"the heat key {self.name!r}"
        refuse_incomplete(what, self, ("name", "meaning", "entry", "usual"))

    def varying_over(self, *over: str) -> Self:
        """Return the key for a law that allows tables over these quantities only."""
        return replace(self, over=over)

    @property
    def annotation(self) -> object:
        """Type of the field of the case, with how it is read."""
        match self.entry:
            case Quantity():
                return Annotated[float | None, self.entry]
            case Varying():
                return Annotated[Variation | None, self.entry]
            case _:
                return self.entry

    @property
    def is_number(self) -> bool:
        """Whether its value is a number or a table of it."""
        return isinstance(self.entry, Quantity | Tabulated | Varying | PlacedOverTime)

    def read(self, value: object) -> object:
        """Return the checked value of a key that is a number or a table of it.

        Raises:
            CaseError: the value is refused.
        """
        assert isinstance(self.entry, Quantity | Tabulated | Varying | PlacedOverTime)
        return self.entry.read(value)

    @property
    def unit(self) -> str:
        """SI unit; "": it has none, or there are several numbers."""
        kind = self.entry
        if isinstance(kind, Varying | Tabulated | PlacedOverTime):
            kind = kind.value
        return kind.dimension.unit if isinstance(kind, Quantity) else ""

    @property
    def text(self) -> str:
        """Name and unit: "closed [W/m²/K]"."""
        unit = self.unit.replace("^2", "²").replace("^3", "³").replace("*", " ")
        unit = unit.replace("degC", "°C")
        return f"{self.name} [{unit}]" if unit else self.name


@dataclass(frozen=True)
class Given:
    """Values of the keys that an interface, a part of it or a surface gives to its law.

    Args:
        values: numbers in SI, tables and tables of keys, by key.
    """

    values: Mapping[str, object]

    def get(self, key: HeatKey[T]) -> T | None:
        """Return the value of a key, or its default."""
        return cast("T | None", self.values.get(key.name, key.default))

    def need(self, key: HeatKey[T]) -> T:
        """Return the value of a key that the law cannot do without, or its default."""
        value = self.get(key)
        assert value is not None
        return value

    def has(self, key: HeatKey[object]) -> bool:
        """Return whether a key is given."""
        return self.get(key) is not None


def middle(low: float, high: float) -> float:
    """Return the geometric mean of the ends of a range."""
    return math.sqrt(low * high)


def chosen(usual: object, choose: Choose) -> object:
    """Return usual numbers with each range (low, high) replaced by one number in it."""
    match usual:
        case (float(low), float(high)) if isinstance(usual, tuple):
            return choose(low, high)
        case dict():
            return {name: chosen(value, choose) for name, value in usual.items()}
        case list():
            return [chosen(value, choose) for value in usual]
        case _:
            return usual


def no_problems(given: Given) -> Iterator[Problem]:
    """Yield no problem: all keys of the law are consistent with each other."""
    yield from ()


@dataclass(frozen=True, kw_only=True, eq=False)
class GapHeatLaw:
    """Declaration of the heat conduction between facing surfaces by the file of a law.

    Attributes:
        name: as a case file writes it; the file has the same, with underscores for hyphens.
        summary: the law in one sentence.
        formula: h [W/m²/K] as text, with g the gap, p the pressure, k the conductivity of the gas.
        source: author, year, section and equation.
        build: from the given keys to the law of the pairs; None where `exchange` is "perfect".
        needed: keys without which there is no law.
        useful: keys that it can use besides.
        instead: keys whose place another one can take: {OPEN: (GAS_CONDUCTIVITY,)}.
        problems: yields inconsistencies between keys that are each allowed.
        exchange: "law": by the law that is built, and by radiation; "perfect": facing nodes have
            one temperature; "none": as the first, but nothing is conducted.
        needs_solid_fraction: whether it depends on the solid fraction of the secondary body.
        follows_gap: whether its conductance falls as the gap opens.
    """

    name: str = ""
    summary: str = ""
    formula: str = ""
    source: str = ""
    build: Callable[[Given], ConductionLaw] | None = None
    needed: tuple[HeatKey[object], ...] = ()
    useful: tuple[HeatKey[object], ...] = ()
    instead: Mapping[HeatKey[object], tuple[HeatKey[object], ...]] = field(default_factory=dict)
    problems: Callable[[Given], Iterator[Problem]] = no_problems
    exchange: Literal["law", "perfect", "none"] = "law"
    needs_solid_fraction: bool = False
    follows_gap: bool = False

    def __post_init__(self) -> None:
        """Refuse a law that is not declared completely.

        Raises:
            TypeError: with what is missing.
        """
        built = () if self.exchange == "perfect" else ("build",)
        required = ("name", "summary", "formula", "source", *built)
        refuse_incomplete(f"the gap heat law {self.name!r}", self, required)

    @property
    def keys(self) -> tuple[HeatKey[object], ...]:
        """All keys, the needed ones first."""
        return (*self.needed, *self.useful)

    def example(
        self, choose: Choose = middle, also: Collection[HeatKey[object]] = ()
    ) -> dict[str, object]:
        """Return the heat transfer of an interface as a case gives it, with usual numbers.

        Args:
            choose: from the ends of a usual range to a number in it.
            also: keys besides the needed ones.
        """
        keys = (*self.needed, *also)
        return {"law": self.name} | {key.name: chosen(key.usual, choose) for key in keys}
