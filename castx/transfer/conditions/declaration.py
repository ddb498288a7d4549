"""What the file of a heat condition declares: name, keys, formula, source, flux or temperature."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from castx.arrays import FloatArray
from castx.input.located import OverTime
from castx.input.placed import PlacedFormula, PlacedTable
from castx.input.registry import refuse_incomplete
from castx.input.units import TEMPERATURE
from castx.tables import Table
from castx.transfer.declaration import Choose, Given, HeatKey, chosen, middle


class FluxLaw(Protocol):
    """Heat flux into a body over a step, at the surface temperature at its end.

    Numbers over time enter by their mean over the step, so that a source that is on for less than
    a step counts in full.
    """

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux [W/m²] and its derivative over temperature [W/m²/K].

        Args:
            start: of the step [s].
            end: of the step [s].
            temperature: of the surface [°C], shape (nodes,).
        """
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class HeatConditionKind:
    """How heat passes through a surface, as the file of a heat condition declares it.

    A file of `castx/transfer/conditions` holds one as `CONDITION`, which castx finds by itself.
    Exactly one of `flux`, `temperature` and `insulates` is given. Fluxes on one surface add up;
    every other condition stands alone.

    Attributes:
        name: the `type` in a case file; the file has the same, with underscores for hyphens.
        summary: the condition in one sentence.
        formula: heat flux q into the body [W/m²], or what else the surface fulfils, as text.
        source: author, year, section and equation.
        keys: that it needs; those with a default may be left out.
        flux: from the given keys to the law of the flux.
        temperature: from the given keys to the temperature of the surface [°C].
        insulates: whether no heat passes.
    """

    name: str = ""
    summary: str = ""
    formula: str = ""
    source: str = ""
    keys: tuple[HeatKey[Any], ...] = ()
    flux: Callable[[Given], FluxLaw] | None = None
    temperature: Callable[[Given], OverTime] | None = None
    insulates: bool = False

    def __post_init__(self) -> None:
        """Refuse a condition that is not declared completely.

        Raises:
            TypeError: with what is missing.
        """
        what = f"the heat condition {self.name!r}"
        refuse_incomplete(what, self, ("name", "summary", "formula", "source"))
        ways = (self.flux is not None, self.temperature is not None, self.insulates)
        if sum(ways) != 1:
            raise TypeError(f"{what} must declare one of flux, temperature and insulates=True")
        if not self.keys and not self.insulates:
            raise TypeError(f"{what} declares no keys")
        for key in self.keys:
            if not key.is_number:
                raise TypeError(f"{what}: the key {key.name!r} is neither a number nor a table")

    @property
    def needed(self) -> tuple[str, ...]:
        """Names of the keys without default."""
        return tuple(key.name for key in self.keys if key.default is None)

    def key(self, name: str) -> HeatKey[Any] | None:
        """Return the key of a name, None where the condition has no such key."""
        return next((key for key in self.keys if key.name == name), None)

    def temperatures(self, given: Given) -> list[Table | PlacedTable]:
        """Return the temperatures that the given keys name [°C]; formulas name none."""
        found = [given.get(key) for key in self.keys if key.unit == TEMPERATURE.unit]
        named = [v for v in found if v is not None and not isinstance(v, PlacedFormula)]
        return [v if isinstance(v, Table | PlacedTable) else Table.constant(v) for v in named]

    def example(self, choose: Choose = middle) -> Mapping[str, object]:
        """Return the condition as a case gives it, with usual numbers.

        Args:
            choose: from the ends of a usual range to a number in it.
        """
        return {"type": self.name} | {key.name: chosen(key.usual, choose) for key in self.keys}
