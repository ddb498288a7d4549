"""Heat through the surfaces of the bodies: descriptions and nodal evaluation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.errors import CaseError
from castx.heat.body import ThermalBody
from castx.input.variation import Variation
from castx.tables import Table
from castx.transfer.radiation import emission

Kind = Literal["insulated", "temperature", "flux", "convection", "radiation"]

NEEDED: dict[Kind, tuple[str, ...]] = {
    "insulated": (),
    "temperature": ("value",),
    "flux": ("value",),
    "convection": ("coefficient", "ambient"),
    "radiation": ("emissivity", "ambient"),
}
FLUXES: tuple[Kind, ...] = ("flux", "convection", "radiation")
"""Kinds that give a flux; several may act on one surface."""


@dataclass(frozen=True, kw_only=True)
class SurfaceHeat:
    """One heat condition on a named surface of a body; a surface may have several.

    Attributes:
        body: name of the body.
        surface: name of the surface.
        kind: "insulated", "temperature", "flux", "convection" or "radiation".
        value: over time: the temperature [°C], or the flux into the body [W/m²].
        coefficient: of the convection, over time or over the temperature of "film" or "surface"
            [W/m²/K].
        ambient: temperature of the surroundings over time [°C].
        emissivity: of the surface over time.
        bare: whether the surface has the name of a body, which touched or touches it.

    Raises:
        CaseError: the kind is unknown, or a number it needs is missing.
    """

    body: str
    surface: str
    kind: Kind
    value: Table | None = None
    coefficient: Variation | None = None
    ambient: Table | None = None
    emissivity: Table | None = None
    bare: bool = False

    def __post_init__(self) -> None:
        if self.kind not in NEEDED:
            raise CaseError(
                f"{self.name}: no heat condition {self.kind!r}; known are {', '.join(NEEDED)}"
            )
        for needed in NEEDED[self.kind]:
            if getattr(self, needed) is None:
                raise CaseError(f"{self.name}: the heat condition {self.kind!r} needs {needed!r}")

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

    What is given over time enters by its mean over the step, so that nothing is lost of a source
    that is on for less than a step.
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
    """Flux h·(T_ambient(t) − T), h over time or temperature.

    The temperature is that of the film, (T + T_ambient)/2, or that of the surface.
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
    """Flux ε(t) σ (T_ambient⁴ − T⁴) between a surface and large surroundings (absolute T)."""

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


def flux_law(description: SurfaceHeat) -> FluxLaw:
    """Return the law of a condition that gives a flux."""
    match description.kind:
        case "convection":
            assert description.coefficient is not None and description.ambient is not None
            return Convection(description.coefficient, description.ambient)
        case "radiation":
            assert description.emissivity is not None and description.ambient is not None
            return SurfaceRadiation(description.emissivity, description.ambient)
        case _:
            assert description.value is not None
            return GivenFlux(description.value)


class SurfaceFlux:
    """A flux law on the owned nodes of a surface.

    Args:
        body: the body.
        description: a condition that gives a flux.
    """

    def __init__(self, body: ThermalBody, description: SurfaceHeat) -> None:
        self.name, self.mechanism = description.name, description.kind
        self.body = body
        self.nodes, self.areas = body.surface_areas(description.surface)
        self.law = flux_law(description)

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
        assert description.value is not None
        self.name, self.mechanism = description.name, description.kind
        self.body = body
        self.value = description.value
        nodes = body.mesh.surface_nodes(description.surface)
        self.nodes: IntArray = nodes[nodes < body.owned].astype(np.int32)

    def temperature(self, time: float) -> float:
        """Return the temperature [°C] at a time [s]."""
        return float(self.value(time))
