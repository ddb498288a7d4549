"""Prescribed, uniform temperatures of bodies in place of a heat problem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import fem

from castx.heat import HeatReport
from castx.materials import Material
from castx.mesh import CastingMesh
from castx.tables import FloatArray, Table


@dataclass(frozen=True)
class PrescribedBody:
    """Material of a body and its temperature over time [°C]."""

    material: Material
    temperature: Table


class PrescribedTemperatures:
    """The fields of a heat problem, given as functions of time; there is no enthalpy.

    Args:
        mesh: mesh of all bodies.
        bodies: by name.
    """

    def __init__(self, mesh: CastingMesh, bodies: Mapping[str, PrescribedBody]) -> None:
        self._bodies = dict(bodies)
        spaces = {name: mesh.bodies[name].nodes for name in bodies}
        self.temperature = {n: fem.Function(space) for n, space in spaces.items()}
        self.enthalpy: dict[str, fem.Function] = {}
        self.solid_fraction = {n: fem.Function(space) for n, space in spaces.items()}
        self._time = 0.0
        self._set(0.0)

    def _set(self, time: float) -> None:
        self._trial = time
        for name, body in self._bodies.items():
            T = np.full_like(self.temperature[name].x.array, float(body.temperature(time)))
            self.temperature[name].x.array[:] = T
            self.solid_fraction[name].x.array[:] = body.material.solid_fraction_at(T)

    def advance(
        self,
        time: float,
        step: float,
        resistances: Sequence[tuple[FloatArray, FloatArray] | None] = (),
        substeps: int = 1,
    ) -> HeatReport:
        """Set the temperatures at the end of a step."""
        before = {name: float(body.temperature(time)) for name, body in self._bodies.items()}
        self._set(time + step)
        changes = [
            abs(float(body.temperature(time + step)) - before[name])
            for name, body in self._bodies.items()
        ]
        return HeatReport(0, 0, max(changes))

    def commit(self) -> None:
        """Make the trial temperatures the present ones."""
        self._time = self._trial

    def rewind(self) -> None:
        """Return to the temperatures of the last commit."""
        self._set(self._time)

    def totals(self) -> dict[str, float]:
        """Return no totals: nothing is exchanged."""
        return {}

    def destroy(self) -> None:
        """Free nothing: no PETSc object is held."""
