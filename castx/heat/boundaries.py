"""Heat through the surfaces of the bodies: descriptions and nodal evaluation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.case.boundaries import FLUXES, HeatCondition
from castx.heat.body import ThermalBody
from castx.input.variation import Variation
from castx.tables import Table
from castx.transfer.radiation import emission


@dataclass(frozen=True, kw_only=True)
class SurfaceHeat:
    """One heat condition on a named surface of a body; a surface may have several.

    Attributes:
        body: name of the body.
        surface: name of the surface.
        condition: what the case says.
        bare: whether the surface has the name of a body, which touched or touches it.
    """

    body: str
    surface: str
    condition: HeatCondition
    bare: bool = False

    @property
    def gives_flux(self) -> bool:
        """Whether the condition gives a flux."""
        return self.condition.type in FLUXES

    @property
    def gives_temperature(self) -> bool:
        """Whether the condition gives the temperature of the surface."""
        return self.condition.type == "temperature"

    @property
    def name(self) -> str:
        """Body and surface as in a case file: "mould/outside"."""
        return f"{self.body}/{self.surface}"

    @property
    def place(self) -> str:
        """Name for totals; an interface may be called "casting/mould" as well."""
        return f"{self.name}.surface" if self.bare else self.name


class FluxLaw(Protocol):
    """Heat flux into a body over a step, at the surface temperature at its end.

    Numbers over time enter by their mean over the step, so that a source that is on for less than
    a step counts in full.
    """

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux [W/m²] and its derivative over temperature [W/m²/K]."""
        ...


@dataclass(frozen=True)
class GivenFlux:
    """Flux given over time [W/m²]."""

    value: Table

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its zero derivative."""
        return np.full_like(temperature, self.value.mean(start, end)), np.zeros_like(temperature)


@dataclass(frozen=True)
class Convection:
    """Flux q = h·(T_ambient(t) − T), h over time or temperature.

    The temperature is that of the film, (T + T_ambient)/2, or that of the surface.
    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.2.
    """

    coefficient: Variation
    ambient: Table

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its derivative."""
        ambient, table = self.ambient.mean(start, end), self.coefficient.table
        if self.coefficient.over == "time":
            h = np.full_like(temperature, table.mean(start, end))
            slope = np.zeros_like(temperature)
        else:
            share = 0.5 if self.coefficient.of == "film" else 1.0
            deciding = share * temperature + (1.0 - share) * ambient
            h, slope = table(deciding), share * table.derivative(deciding)
        return h * (ambient - temperature), slope * (ambient - temperature) - h


@dataclass(frozen=True)
class SurfaceRadiation:
    """Flux q = ε(t) σ (T_ambient⁴ − T⁴) from large surroundings, T absolute.

    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 9.3.
    """

    emissivity: Table
    ambient: Table

    def __call__(
        self, start: float, end: float, temperature: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its derivative."""
        emissivity = self.emissivity.mean(start, end)
        received, _ = emission(np.asarray(self.ambient.mean(start, end)))
        emitted, slope = emission(temperature)
        return emissivity * (received - emitted), -emissivity * slope


def flux_law(condition: HeatCondition) -> FluxLaw:
    """Return the law of a condition that gives a flux."""
    match condition.type:
        case "convection":
            assert condition.coefficient is not None and condition.ambient is not None
            return Convection(condition.coefficient, condition.ambient)
        case "radiation":
            assert condition.emissivity is not None and condition.ambient is not None
            return SurfaceRadiation(condition.emissivity, condition.ambient)
        case _:
            assert condition.value is not None
            return GivenFlux(condition.value)


class SurfaceFlux:
    """A flux law on the owned nodes of a surface.

    Args:
        body: the body.
        description: a condition that gives a flux.
    """

    def __init__(self, body: ThermalBody, description: SurfaceHeat) -> None:
        self.body = body
        self.nodes, self.areas = body.surface_areas(description.surface)
        self.law = flux_law(description.condition)

    def evaluate(self, start: float, end: float) -> tuple[FloatArray, FloatArray]:
        """Return heat into the nodes over a step [W] and its derivative over temperature [W/K]."""
        flux, slope = self.law(start, end, self.body.owned_temperature[self.nodes])
        return self.areas * flux, self.areas * slope


class SurfaceTemperature:
    """A prescribed temperature on the owned nodes of a surface.

    Args:
        body: the body.
        description: a condition that gives the temperature.
    """

    def __init__(self, body: ThermalBody, description: SurfaceHeat) -> None:
        assert description.condition.value is not None
        self.body = body
        self.value = description.condition.value
        nodes = body.mesh.surface_nodes(description.surface)
        self.nodes: IntArray = nodes[nodes < body.owned].astype(np.int32)

    def temperature(self, time: float) -> float:
        """Return the temperature [°C] at a time [s]."""
        return float(self.value(time))
