"""Descriptions of the interfaces between bodies: contact and law of heat transfer."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import Field, PlainValidator

from castx.contact.description import Contact
from castx.entries import Choice, Description, EntryName, NotYet, Quantity
from castx.errors import CaseError
from castx.refusal import Problem
from castx.tables import FloatArray
from castx.units import (
    CONDUCTIVITY,
    HEAT_TRANSFER,
    PURE_NUMBER,
    STRESS,
    THERMAL_RESISTANCE,
)

_NEEDED: dict[str, tuple[str, ...]] = {
    "limited": ("closed", "gas_conductivity"),
    "series": ("closed", "gas_conductivity"),
    "constant": ("closed",),
    "perfect": (),
    "none": (),
}
_SMALLEST_RELATIVE_PRESSURE = 1e-6  # of the hardness; the closed law is straight below it


class ContactConductance(Description):
    """Heat transfer that contact pressure adds, (1/R)(p/H_e)^b: R [m²K/W], H_e [Pa], b."""

    resistance: Annotated[float, Quantity(THERMAL_RESISTANCE, above=0.0)]
    hardness: Annotated[float, Quantity(STRESS, above=0.0)]
    exponent: Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=5.0)] = 0.95
    roughness: Annotated[None, NotYet()] = None
    coating: Annotated[None, NotYet()] = None

    def __call__(self, pressure: npt.ArrayLike) -> FloatArray:
        """Return the added coefficient [W/m²/K] at contact pressures [Pa], in their shape.

        For b < 1 the slope of the law is unbounded at p = 0; up to a millionth of the hardness the
        law is therefore the straight line that meets it there.
        """
        relative = np.maximum(np.asarray(pressure, dtype=np.float64), 0.0) / self.hardness
        floor = _SMALLEST_RELATIVE_PRESSURE if self.exponent < 1.0 else 0.0
        power = np.maximum(relative, floor) ** (self.exponent - 1.0)
        return np.asarray(relative * power / self.resistance)


def _closed(value: Any) -> float:
    if isinstance(value, dict):
        raise CaseError("a table over another variable is not available yet; give one number")
    return Quantity(HEAT_TRANSFER, above=0.0).read(value)


class InterfaceHeat(Description):
    """Heat transfer between the facing surfaces, q = h (T_secondary − T_primary).

    `closed` [W/m²/K] is the coefficient of touching surfaces without pressure;
    `gas_conductivity` [W/m/K] that of the gas in the gap; `pressure` adds to closed contact.
    """

    law: Annotated[str, Choice(tuple(_NEEDED), ("solid-fraction",))]
    closed: Annotated[float, PlainValidator(_closed)] = 0.0
    gas_conductivity: Annotated[float, Quantity(CONDUCTIVITY, above=0.0)] = 0.0
    pressure: ContactConductance | None = None
    open: Annotated[None, NotYet()] = None
    radiation: Annotated[None, NotYet()] = None
    roughness: Annotated[None, NotYet()] = None
    coating: Annotated[None, NotYet()] = None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield what the law lacks or cannot use."""
        needed = _NEEDED[self.law]
        usable = (*needed, "pressure") if needed else ()
        for key in ("closed", "gas_conductivity", "pressure"):
            if key in needed and key not in self.model_fields_set:
                yield Problem((key,), f"missing; the law {self.law!r} needs it")
            if key not in usable and key in self.model_fields_set:
                used = ", ".join(usable) or "no further numbers"
                yield Problem((key,), f"the law {self.law!r} takes {used}")

    def coefficient(self, gap: npt.ArrayLike, pressure: npt.ArrayLike) -> FloatArray:
        """Return the heat-transfer coefficient h [W/m²/K].

        Closed: closed + (1/R)(p/H_e)^b. Open: limited min(closed, k/g), series 1/(1/closed + g/k).
        Both meet at g = p = 0. Perfect contact is infinite, none is zero. Source: M. Chiumenti,
        Thermo-mechanical contact in casting analysis, section 9, with its min/max settled.

        Args:
            gap: opening g [m], shape (n,); negative counts as closed.
            pressure: contact pressure [Pa], shape (n,); negative counts as none.
        """
        opening = np.maximum(np.asarray(gap, dtype=np.float64), 0.0)
        shape = np.broadcast(opening, pressure).shape
        if self.law in ("none", "perfect"):
            return np.full(shape, np.inf if self.law == "perfect" else 0.0)
        through = self._through_gap(opening)
        if self.pressure is not None:
            through = through + self.pressure(pressure)
        return np.array(np.broadcast_to(through, shape))

    def _through_gap(self, opening: FloatArray) -> FloatArray:
        if self.law == "constant":
            return np.full(opening.shape, self.closed)
        resistance = opening / self.gas_conductivity
        if self.law == "series":
            return np.asarray(1.0 / (1.0 / self.closed + resistance))
        return np.asarray(1.0 / np.maximum(1.0 / self.closed, resistance))


class Interface(Description):
    """Two bodies that face each other: secondary (casting side), primary (mould side)."""

    bodies: Annotated[tuple[EntryName, ...], Field(min_length=2, max_length=2)]
    contact: Contact = Contact()
    heat: InterfaceHeat | None = None

    @property
    def secondary(self) -> str:
        """Body on the casting side."""
        return self.bodies[0]

    @property
    def primary(self) -> str:
        """Body on the mould side, whose outward normal is the normal of the pairs."""
        return self.bodies[1]

    @property
    def name(self) -> str:
        """Name as "secondary/primary"."""
        return "/".join(self.bodies)
