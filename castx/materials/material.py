"""Material: the properties and curves that the solvers read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.materials.description import Liquid, MaterialDescription
from castx.materials.enthalpy import EnthalpyCurve, enthalpy_curve
from castx.materials.phased import Phased
from castx.materials.solid_fraction import (
    LeverLaw,
    LinearLaw,
    Plateau,
    ScheilLaw,
    SolidFractionLaw,
    fraction_at,
    plateaus,
    temperature_at,
)
from castx.materials.sources import (
    OutsideRange,
    Property,
    PropertyRow,
    Source,
    outside_range,
    properties,
    property_rows,
)
from castx.tables import Table

Value = TypeVar("Value")

PURPOSES = {"density": "the heat equation and gravity"}

ATMOSPHERE = 1.01e5
"""Depression at which a void opens in melt without tensile strength and without gas [Pa]."""


@dataclass(frozen=True, eq=False)
class Material:
    """A complete description with the curves that follow from it.

    Args:
        name: as in the case or the database.
        description: does not extend another.
        sources: by property, where known.
    """

    name: str
    description: MaterialDescription
    sources: Mapping[str, Source] = field(default_factory=dict)

    @property
    def density(self) -> float:
        """Reference density [kg/m³]."""
        return self._given("density", self.description.density)

    @property
    def heat_capacity(self) -> Phased:
        """Heat capacity per mass [J/kg/K]."""
        return self._given("heat_capacity", self.description.heat_capacity)

    @property
    def conductivity(self) -> Phased:
        """Thermal conductivity [W/m/K]."""
        return self._given("conductivity", self.description.conductivity)

    @property
    def melts(self) -> bool:
        """Whether the material has a solidus and a liquidus."""
        return self.description.freezing_range is not None

    @property
    def solidus(self) -> float | None:
        """Temperature below which the material is solid [°C]; None: the material never melts."""
        freezing = self.description.freezing_range
        return freezing[0] if freezing else None

    @property
    def liquidus(self) -> float | None:
        """Temperature above which the material is liquid [°C]; None: the material never melts."""
        freezing = self.description.freezing_range
        return freezing[1] if freezing else None

    @property
    def latent_heat(self) -> float:
        """Latent heat per mass [J/kg]; 0: the material never melts."""
        return self.description.latent_heat or 0.0

    @property
    def young_modulus(self) -> Table | None:
        """Young's modulus over temperature [Pa]."""
        return self.description.young_modulus

    @property
    def poisson_ratio(self) -> Table | None:
        """Poisson's ratio over temperature."""
        return self.description.poisson_ratio

    @property
    def expansion(self) -> Table | None:
        """Mean linear thermal expansion from the reference to a temperature [1/K]."""
        return self.description.expansion

    @property
    def expansion_reference(self) -> float | None:
        """Temperature from which the mean expansion counts [°C]; None: the stress-free one."""
        return self.description.expansion_reference

    @property
    def stress_free(self) -> float | None:
        """Stress-free temperature as given [°C]."""
        return self.description.stress_free

    @property
    def liquid(self) -> Liquid | None:
        """Law below coherency; None: the solid's elastic law holds at every temperature."""
        return self.description.liquid

    @property
    def is_isothermal(self) -> bool:
        """Whether it freezes at one temperature, behind a front without a mush."""
        return self.melts and self.solidus == self.liquidus

    @property
    def fed_until(self) -> float:
        """Solid fraction up to which liquid feeds what shrinks; zero without a liquid.

        It is coherency in an alloy. A front is fed wholly where no mush ahead of it bears: in a
        metal that freezes at one temperature, and on a plateau that contains coherency, to its end.
        """
        if self.liquid is None:
            return 0.0
        if self.is_isothermal:
            return 1.0
        coherency = self.liquid.coherency
        ends = [plateau.end for plateau in self.plateaus if plateau.begin <= coherency]
        return max([coherency, *ends])

    def bearing_share(self, solid_fraction: FloatArray) -> FloatArray:
        """Return the share w of metal that bears stress at solid fractions of its nodes.

        In an alloy it rises from 0 at coherency to 1 in the solid. What freezes at one temperature
        bears behind its front, however little it is: w = f_s.
        """
        fraction = np.asarray(solid_fraction, dtype=np.float64)
        if self.liquid is None:
            return np.ones_like(fraction)
        coherency = 0.0 if self.is_isothermal else self.liquid.coherency
        if coherency >= 1.0:
            return (fraction >= 1.0).astype(np.float64)
        return np.clip((fraction - coherency) / (1.0 - coherency), 0.0, 1.0)

    @cached_property
    def plateaus(self) -> tuple[Plateau, ...]:
        """Plateaus of the metal, parts that freeze at one temperature, the coldest first."""
        law = self.solid_fraction
        if law is None or self.solidus is None or self.liquidus is None:
            return ()
        return plateaus(law, self.solidus, self.liquidus)

    @property
    def cavitation(self) -> float:
        """Depression below the surroundings at which pores open in trapped melt [Pa]; or none.

        Melt that holds gas needs no tension: its default here is zero.
        """
        return self.description.cavitation or 0.0

    @property
    def wall_suction(self) -> float:
        """Depression at which melt lets go of a wall, to leave a void there [Pa]."""
        given = self.description.cavitation
        return ATMOSPHERE if given is None else given

    @property
    def dissipation(self) -> float:
        """Fraction of the plastic work that becomes heat."""
        return self.description.dissipation

    @property
    def solid_fraction(self) -> SolidFractionLaw | None:
        """Law of the solid fraction between solidus and liquidus; None: it never melts."""
        law = self.description.solid_fraction
        if not self.melts:
            return None
        if not isinstance(law, str):
            return law
        coefficient = self.description.partition_coefficient
        melting_point = self.description.melting_point
        if coefficient is None or melting_point is None:
            return LinearLaw()
        alloy = LeverLaw if law == "lever" else ScheilLaw
        return alloy(coefficient, melting_point)

    @cached_property
    def enthalpy(self) -> EnthalpyCurve:
        """Volumetric enthalpy ⇄ temperature, solid fraction."""
        return enthalpy_curve(
            self.density,
            self.heat_capacity,
            latent_heat=self.latent_heat,
            solidus=self.solidus,
            liquidus=self.liquidus,
            law=self.solid_fraction,
        )

    def solid_fraction_at(self, temperature: FloatArray) -> FloatArray:
        """Return f_s at temperatures [°C] in equilibrium; needs no thermal property."""
        if self.solid_fraction is None or self.solidus is None or self.liquidus is None:
            return np.ones_like(temperature)
        return fraction_at(self.solid_fraction, self.solidus, self.liquidus, temperature)

    def temperature_at(self, solid_fraction: float) -> float:
        """Return the highest temperature of so much solid, or more [°C]; of what melts."""
        if self.solid_fraction is None or self.solidus is None or self.liquidus is None:
            return np.inf
        return temperature_at(self.solid_fraction, self.solidus, self.liquidus, solid_fraction)

    @property
    def given_stress_free(self) -> float | None:
        """Stress-free temperature of the case [°C]; None if it comes from the database."""
        return None if "stress_free" in self.sources else self.stress_free

    @property
    def contraction_start(self) -> float | None:
        """Temperature from which the freezing metal contracts [°C]; None: it never melts.

        That of the database where it has one, else the solidus.
        """
        tabled = None if self.given_stress_free is not None else self.stress_free
        return self.solidus if tabled is None else tabled

    def stress_free_temperature(self, initial: float) -> float:
        """Return the stress-free temperature [°C] of a casting, or of a body that never melts.

        Args:
            initial: its initial temperature [°C].
        """
        if self.stress_free is not None:
            return self.stress_free
        return initial if self.solidus is None else self.solidus

    def without_liquid(self) -> Material:
        """Return the material with the solid's elastic law at every temperature, unshrunk."""
        changes = {"liquid": None, "solidification_shrinkage": 0.0}
        description = self.description.model_copy(update=changes)
        return replace(self, description=description)

    def without_shrinkage(self) -> Material:
        """Return the material without strain of solidification, of which its melt takes care."""
        changes = {"solidification_shrinkage": 0.0}
        return replace(self, description=self.description.model_copy(update=changes))

    def require(self, properties: Sequence[str], purpose: str) -> None:
        """Check that properties are given.

        Args:
            properties: keys of the case format.
            purpose: use of the properties, for the message.

        Raises:
            CaseError: names all that are missing.
        """
        missing = [name for name in properties if getattr(self.description, name) is None]
        if missing:
            raise CaseError(
                f"material {self.name!r} has no {', '.join(missing)}, needed by {purpose}; "
                f"add to [materials.{self.name}] of the case"
            )

    def outside_range(self, lowest: float, highest: float, near: float = 0.0) -> list[OutsideRange]:
        """Return the properties that temperatures [°C] take out of range by more than near [K]."""
        return outside_range(self.description, self.sources, lowest, highest, near)

    def properties(self) -> list[Property]:
        """Return all properties with unit, source and range, in the order of the case format."""
        return list(properties(self.description, self.sources))

    def rows(self) -> list[PropertyRow]:
        """Return all numbers with unit and source, tables row by row."""
        return list(property_rows(self.description, self.sources))

    def _given(self, name: str, value: Value | None) -> Value:
        if value is None:
            self.require((name,), PURPOSES.get(name, "the heat equation"))
            raise AssertionError(name)
        return value
