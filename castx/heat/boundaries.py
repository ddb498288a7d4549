"""Heat through the surfaces of the bodies: descriptions and nodal evaluation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.case.boundaries import HeatCondition
from castx.heat.body import ThermalBody


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
        return self.condition.declared.flux is not None

    @property
    def gives_temperature(self) -> bool:
        """Whether the condition gives the temperature of the surface."""
        return self.condition.declared.temperature is not None

    @property
    def name(self) -> str:
        """Body and surface as in a case file: "mould/outside"."""
        return f"{self.body}/{self.surface}"

    @property
    def place(self) -> str:
        """Name for totals; an interface may be called "casting/mould" as well."""
        return f"{self.name}.surface" if self.bare else self.name


class SurfaceFlux:
    """A flux law on the owned nodes of a surface.

    Args:
        body: the body.
        description: a condition that gives a flux.
    """

    def __init__(self, body: ThermalBody, description: SurfaceHeat) -> None:
        self.body = body
        self.nodes, self.areas = body.surface_areas(description.surface)
        flux = description.condition.declared.flux
        assert flux is not None
        self.law = flux(description.condition.given)

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
        temperature = description.condition.declared.temperature
        assert temperature is not None
        self.body = body
        self.value = temperature(description.condition.given)
        nodes = body.mesh.surface_nodes(description.surface)
        self.nodes: IntArray = nodes[nodes < body.owned].astype(np.int32)

    def temperature(self, time: float) -> float:
        """Return the temperature [°C] at a time [s]."""
        return float(self.value(time))
