"""Heat through the surfaces of the bodies: descriptions and nodal evaluation."""

from __future__ import annotations

from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.case.boundaries import HeatCondition
from castx.errors import CaseError
from castx.heat.body import ThermalBody
from castx.input.located import PlacedThere
from castx.input.placed import Placed
from castx.input.units import ABSOLUTE_ZERO
from castx.transfer.declaration import Given


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


class PlacedNumbers:
    """Numbers of a condition at the owned nodes of its surface, where it varies with place.

    Args:
        body: the body.
        description: a condition.
        nodes: owned nodes of its surface, (nodes,).
    """

    def __init__(self, body: ThermalBody, description: SurfaceHeat, nodes: IntArray) -> None:
        values = description.condition.given.values
        self._placed = [value for value in values.values() if isinstance(value, Placed)]
        self._comm, self._name = body.mesh.mesh.comm, description.name
        points = body.mesh.points[nodes, : body.mesh.mesh.geometry.dim]
        self.given = Given({
            name: PlacedThere(value, points) if isinstance(value, Placed) else value
            for name, value in values.items()
        })  # fmt: skip

    @property
    def vary(self) -> bool:
        """Whether any of them varies with place, and may be none somewhere."""
        return bool(self._placed)

    def refuse(self, wrong: BoolArray, what: str, time: float) -> None:
        """Refuse numbers that are none; collective.

        Args:
            wrong: nodes at which they are none.
            what: they are.
            time: of the numbers [s].

        Raises:
            CaseError: on all ranks, if any node of any rank is wrong.
        """
        if self._comm.allreduce(bool(wrong.any()), op=MPI.LOR):
            said = "; ".join(value.text for value in self._placed)
            raise CaseError(
                f"{self._name}: {what} at {time:g} s, by {said}; correct the formula or the table"
            )


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
        self._numbers = PlacedNumbers(body, description, self.nodes)
        self.law = flux(self._numbers.given)

    def begin(self, start: float, end: float) -> None:
        """Begin a step; collective where the condition varies with place.

        Raises:
            CaseError: a flux is not finite; on all ranks.
        """
        if self._numbers.vary:
            wrong = ~np.isfinite(self.evaluate(start, end)[0])
            self._numbers.refuse(wrong, "the flux is not finite", end)

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
        nodes = body.mesh.surface_nodes(description.surface)
        self.nodes: IntArray = nodes[nodes < body.owned].astype(np.int32)
        self._numbers = PlacedNumbers(body, description, self.nodes)
        self.value = temperature(self._numbers.given)

    def temperature(self, time: float) -> FloatArray:
        """Return the temperature of the nodes [°C] at a time [s]; collective where it varies.

        Raises:
            CaseError: one is not finite, or below absolute zero; on all ranks.
        """
        found = np.broadcast_to(self.value(time), self.nodes.shape)
        if self._numbers.vary:
            wrong = ~(np.isfinite(found) & (found >= ABSOLUTE_ZERO))
            self._numbers.refuse(wrong, "a temperature is none", time)
        return np.asarray(found)
