"""Entries of a case file about two facing surfaces: roughness, coating, pressure, radiation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from castx.arrays import FloatArray
from castx.input.entries import Choice, Description, Quantity
from castx.input.problems import Problem
from castx.input.units import CONDUCTIVITY, LENGTH, PURE_NUMBER, STRESS, THERMAL_RESISTANCE

_NEARLY_ALL = 0.99
"""Share of the outer radius that a gap may have: a surface cannot reach the axis."""
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


class CurvedGap(Description):
    """A gap between concentric cylinders or spheres, so wide that their curvature counts.

    Heat is per area of the first body of the interface, as everywhere.
    Source: F. P. Incropera, D. P. DeWitt, Fundamentals of Heat and Mass Transfer, chapter 3.3
    (conduction through cylinder and sphere), table 13.3 (radiation in two-surface enclosures).

    Attributes:
        shape: "cylinder" or "sphere".
        radii: of both surfaces, in the order of the bodies [m].
    """

    shape: Annotated[str, Choice(("cylinder", "sphere"))]
    radii: Annotated[
        tuple[Annotated[float, Quantity(LENGTH, above=0.0)], ...],
        Field(min_length=2, max_length=2),
    ]

    @property
    def inside(self) -> bool:
        """Whether the first body lies inside the second one."""
        return self.radii[0] < self.radii[1]

    def thickness(self, gap: FloatArray) -> FloatArray:
        """Return the thickness of a plane layer that conducts as well as the gap [m].

        With R the first radius and g the gap it is R ln(1 + g/R) of a cylinder and g/(1 + g/R) of a
        sphere inside the second body; g is negative in both where the second body lies inside.

        Args:
            gap: of pairs [m], shape (pairs,); below the first radius where that is the outer one.
        """
        radius, sign = self.radii[0], 1.0 if self.inside else -1.0
        share = sign * gap / radius
        share = np.maximum(share, -_NEARLY_ALL)
        if self.shape == "cylinder":
            return np.asarray(sign * radius * np.log1p(share))
        return np.asarray(sign * radius * share / (1.0 + share))

    def facing_factor(self, emissivities: Sequence[float]) -> float:
        """Return the factor of radiation per area of the first surface.

        1/(1/ε_i + ρ (1/ε_o − 1)) of the inner surface, with ρ the ratio of both areas, r_i/r_o of
        cylinders and its square of spheres; of the outer one ρ times that.

        Args:
            emissivities: ε of both surfaces, in the order of the bodies.
        """
        ratio = min(self.radii) / max(self.radii)
        areas = ratio if self.shape == "cylinder" else ratio * ratio
        inner, outer = emissivities if self.inside else reversed(emissivities)
        factor = 1.0 / (1.0 / inner + areas * (1.0 / outer - 1.0))
        return factor if self.inside else areas * factor

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield equal radii, of which none is inside."""
        if self.radii[0] == self.radii[1]:
            yield Problem(("radii",), "two different radii are needed, in the order of the bodies")


def mean_depth(roughness: tuple[float, ...] | None) -> float:
    """Return R_z = ½√(R₁² + R₂²) of both sides [m]; zero without roughness.

    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.1.
    """
    return 0.0 if roughness is None else 0.5 * math.hypot(*roughness)
