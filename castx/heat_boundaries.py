"""Heat through the surfaces of the bodies: descriptions and nodal evaluation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
import numpy.typing as npt

from castx.errors import CaseError
from castx.tables import FloatArray, Table
from castx.thermal_body import ThermalBody

IntArray = npt.NDArray[np.int32]
Kind = Literal["insulated", "temperature", "flux", "convection"]

NEEDED: dict[Kind, tuple[str, ...]] = {
    "insulated": (),
    "temperature": ("value",),
    "flux": ("value",),
    "convection": ("coefficient", "ambient"),
}


@dataclass(frozen=True, kw_only=True)
class SurfaceHeat:
    """One heat condition on a named surface of a body; a surface may have several.

    Attributes:
        body: name of the body.
        surface: name of the surface.
        kind: "insulated", "temperature", "flux" or "convection".
        value: over time: the temperature [°C], or the flux into the body [W/m²].
        coefficient: of the convection over time [W/m²/K].
        ambient: temperature of the surroundings over time [°C].

    Raises:
        CaseError: the kind is unknown, or a number it needs is missing.
    """

    body: str
    surface: str
    kind: Kind
    value: Table | None = None
    coefficient: Table | None = None
    ambient: Table | None = None

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


class FluxLaw(Protocol):
    """Heat flux into a body as a function of time and surface temperature."""

    def __call__(self, time: float, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the flux [W/m²] and its derivative over temperature [W/m²/K]."""
        ...


@dataclass(frozen=True)
class GivenFlux:
    """Flux given over time [W/m²]."""

    value: Table

    def __call__(self, time: float, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its zero derivative."""
        return np.full_like(temperature, self.value(time)), np.zeros_like(temperature)


@dataclass(frozen=True)
class Convection:
    """Flux h(t)·(T_ambient(t) − T)."""

    coefficient: Table
    ambient: Table

    def __call__(self, time: float, temperature: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the flux and its derivative."""
        coefficient = float(self.coefficient(time))
        flux = coefficient * (float(self.ambient(time)) - temperature)
        return flux, np.full_like(temperature, -coefficient)


class SurfaceFlux:
    """A flux law on the owned nodes of a surface.

    Args:
        body: the body.
        description: a condition that gives a flux.
    """

    def __init__(self, body: ThermalBody, description: SurfaceHeat) -> None:
        self.name = description.name
        self.body = body
        self.nodes, self.areas = body.surface_areas(description.surface)
        self.law: FluxLaw
        if description.kind == "convection":
            assert description.coefficient is not None and description.ambient is not None
            self.law = Convection(description.coefficient, description.ambient)
        else:
            assert description.value is not None
            self.law = GivenFlux(description.value)

    def evaluate(self, time: float) -> tuple[FloatArray, FloatArray]:
        """Return heat into the nodes [W] and its derivative over their temperature [W/K]."""
        flux, slope = self.law(time, self.body.owned_temperature[self.nodes])
        return self.areas * flux, self.areas * slope


class SurfaceTemperature:
    """A prescribed temperature on the owned nodes of a surface.

    Args:
        body: the body.
        description: a condition that gives the temperature.
    """

    def __init__(self, body: ThermalBody, description: SurfaceHeat) -> None:
        assert description.value is not None
        self.name = description.name
        self.body = body
        self.value = description.value
        nodes = body.mesh.surface_nodes(description.surface)
        self.nodes: IntArray = nodes[nodes < body.owned].astype(np.int32)

    def temperature(self, time: float) -> float:
        """Return the temperature [°C] at a time [s]."""
        return float(self.value(time))
