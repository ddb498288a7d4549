"""The bodies of a case: material, initial temperature, constitutive law, elements."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import Field, PlainValidator, StrictStr

from castx.case.initial_temperature import MISSING, InitialTemperature, read_initial_temperature
from castx.input.entries import (
    TEMPERATURES,
    TIMES,
    Choice,
    Description,
    EntryName,
    Tabulated,
    over_time,
)
from castx.input.problems import Problem
from castx.input.units import HEAT_SOURCE
from castx.materials.description import MaterialDescription
from castx.materials.material import Material
from castx.tables import Table

AUTOMATIC, AT_NODES, IN_CELLS = "automatic", "nodes", "cells"
"""Where freezing is found, as a case says it."""
POCKETS, DARCY = "pockets", "darcy"
"""How liquid is fed, likewise."""


def _start_of_history(body: dict[str, Any]) -> InitialTemperature:
    history = body.get("temperature_history")
    if not isinstance(history, Table):
        return MISSING
    return InitialTemperature(Table.constant(float(history.values[0])))


class Body(Description):
    """One body: a named volume of the mesh with its material, temperature at the start and law.

    Attributes:
        name: of the volume in the mesh.
        material: a name of the database or of the case's own materials.
        temperature_history: prescribed temperature over time [°C].
        temperature: initial one [°C], uniform, along a coordinate or from a file; by default the
            start of `temperature_history`.
        heat_source: over time [W/m³].
        law: constitutive law.
        formulation: finite elements of the displacement; None: "mixed" on simplices, else
            "q1p0".
        stabilisation: of the mixed formulation.
        feeding: how liquid is fed: one pressure in each trapped pocket, or flow through the mush.
        freezing: where latent heat and the share that bears are found, at nodes or inside cells;
            "automatic" is what suits the metal, see `castx.case.reading.freezing`.
    """

    name: EntryName
    material: Annotated[StrictStr, Field(max_length=100)]
    temperature_history: Annotated[Table | None, Tabulated(TEMPERATURES, TIMES)] = None
    temperature: Annotated[InitialTemperature, PlainValidator(read_initial_temperature)] = Field(
        default_factory=_start_of_history
    )
    heat_source: Annotated[Table | None, over_time(HEAT_SOURCE)] = None
    law: Annotated[
        str,
        Choice(
            (
                "thermo-elastic",
                "thermo-elasto-plastic",
                "thermo-elasto-viscoplastic",
                "drucker-prager",
                "rigid",
            )
        ),
    ] = "thermo-elastic"
    formulation: Annotated[str | None, Choice(("mixed", "displacement", "q1p0", "taylor-hood"))] = (
        None
    )
    stabilisation: Annotated[str, Choice(("osgs", "gls"))] = "osgs"
    feeding: Annotated[str, Choice((POCKETS, DARCY))] = POCKETS
    freezing: Annotated[str, Choice((AUTOMATIC, AT_NODES, IN_CELLS))] = AUTOMATIC

    def starts_solid(self, material: MaterialDescription) -> bool:
        """Return whether the body starts solid, and stays so if its temperature is prescribed.

        A solid body, a mould or a chill, needs no liquid of its material.

        Args:
            material: of the body.
        """
        history = self.temperature_history
        hottest = self.temperature.hottest if history is None else float(history.values.max())
        freezing = material.freezing_range
        return freezing is None or hottest < freezing[0]

    def is_poured(self, material: Material) -> bool:
        """Return whether the body starts liquid, of a material whose liquid flows.

        Args:
            material: of the body.
        """
        return material.liquid is not None and not self.starts_solid(material.description)

    def inconsistencies(self) -> Iterator[Problem]:
        """Yield a missing initial temperature."""
        if self.temperature.is_missing:
            yield Problem(("temperature",), "missing; the initial temperature in °C is needed")
