"""Entries of a case file about two facing surfaces: roughness, coating, pressure, radiation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated

from pydantic import Field

from castx.input.entries import Description, Quantity
from castx.input.problems import Problem
from castx.input.units import CONDUCTIVITY, LENGTH, PURE_NUMBER, STRESS, THERMAL_RESISTANCE

_DEPTH = Annotated[float, Quantity(LENGTH, least=0.0)]
Roughness = Annotated[tuple[_DEPTH, ...], Field(min_length=2, max_length=2)]
"""Peak-to-valley heights of both surfaces, in the order of the bodies [m]."""


class Coating(Description):
    """A layer on the mould: thickness δ [m] and conductivity k [W/m/K], of resistance δ/k."""

    thickness: Annotated[float, Quantity(LENGTH, above=0.0)]
    conductivity: Annotated[float, Quantity(CONDUCTIVITY, above=0.0)]

    @property
    def resistance(self) -> float:
        """δ/k [m² K/W]."""
        return self.thickness / self.conductivity


class ContactConductance(Description):
    """Heat transfer that contact pressure adds, (1/R)(p/H_e)^b: R [m²K/W], H_e [Pa], b.

    R is given, or follows from the roughness of both sides and a coating, here or beside the law.
    """

    resistance: Annotated[float | None, Quantity(THERMAL_RESISTANCE, above=0.0)] = None
    hardness: Annotated[float, Quantity(STRESS, above=0.0)]
    exponent: Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=5.0)] = 0.95
    roughness: Roughness | None = None
    coating: Coating | None = None

    @property
    def rough(self) -> bool:
        """Whether the roughness or coating of its own gives R."""
        return self.roughness is not None or self.coating is not None

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield two ways of giving R."""
        for key in ("roughness", "coating"):
            if self.resistance is not None and getattr(self, key) is not None:
                yield Problem((key,), "resistance is given already; leave one of them out")


class Radiation(Description):
    """Radiation across the gap; emissivities in the order of the bodies."""

    emissivities: Annotated[
        tuple[Annotated[float, Quantity(PURE_NUMBER, above=0.0, most=1.0)], ...],
        Field(min_length=2, max_length=2),
    ]


def mean_depth(roughness: tuple[float, ...] | None) -> float:
    """Return R_z = ½√(R₁² + R₂²) of both sides [m]; zero without roughness.

    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.1.
    """
    return 0.0 if roughness is None else 0.5 * math.hypot(*roughness)
