"""Prescribed, uniform temperatures of bodies in place of a heat problem."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.mesh import CastingMesh
from castx.heat.interface import HeatExchange, coefficients
from castx.heat.problem import HeatReport
from castx.heat.step_error import HeatError
from castx.materials.enthalpy import HeatState
from castx.materials.material import Material
from castx.stateful import Arrays, Saved, number
from castx.tables import Table
from castx.transfer.conductance import Faces
from castx.transfer.pair_state import PairState


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
        exchanges: interfaces, whose coefficients may be asked for although no heat is exchanged.
    """

    def __init__(
        self,
        mesh: CastingMesh,
        bodies: Mapping[str, PrescribedBody],
        exchanges: Sequence[HeatExchange] = (),
    ) -> None:
        self._bodies, self._exchanges = dict(bodies), list(exchanges)
        spaces = {name: mesh.bodies[name].nodes for name in bodies}
        self.temperature = {n: fem.Function(space) for n, space in spaces.items()}
        self.enthalpy: dict[str, fem.Function] = {}
        self.solid_fraction = {n: fem.Function(space) for n, space in spaces.items()}
        # Temperatures that are uniform are those of the nodes.
        self.solid_inside: dict[str, Callable[[], float]] = {n: float for n in spaces}
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
        pairs: Sequence[tuple[PairState, PairState] | None] = (),
        substeps: int = 1,
        dissipation: Mapping[str, FloatArray] | None = None,
        factors: Sequence[FloatArray] | None = None,
    ) -> HeatReport:
        """Set the temperatures at the end of a step."""
        before = {name: float(body.temperature(time)) for name, body in self._bodies.items()}
        self._set(time + step)
        changes = [
            abs(float(body.temperature(time + step)) - before[name])
            for name, body in self._bodies.items()
        ]
        return HeatReport(0, 0, max(changes))

    def step_error(
        self,
        pairs: Sequence[tuple[PairState, PairState] | None] = (),
        factors: Sequence[FloatArray] | None = None,
    ) -> HeatError:
        """Return no error: the temperatures are given."""
        return HeatError(0.0, 0.0)

    def time_to_change(
        self, change: float, pairs: Sequence[tuple[PairState, PairState] | None] = ()
    ) -> float:
        """Return infinity: how steps follow given temperatures is a choice of the case."""
        return float("inf")

    def between(self, name: str) -> Sequence[HeatState]:
        """Return nothing: a step goes straight from its start to its end."""
        return ()

    def coefficients(self, pairs: Sequence[PairState]) -> list[FloatArray]:
        """Return h of pairs in these states [W/m²/K].

        It is infinite in perfect contact and zero where no heat crosses.
        """
        faces = [
            self._faces(exchange, len(state.gap)) if exchange.kind == "law" else None
            for exchange, state in zip(self._exchanges, pairs, strict=True)
        ]
        return coefficients(self._exchanges, faces, pairs)

    def _faces(self, exchange: HeatExchange, count: int) -> Faces:
        secondary = self._bodies[exchange.pairs.secondary]
        both = (secondary, self._bodies[exchange.pairs.primary])
        hot, cold = (np.full(count, float(body.temperature(self._trial))) for body in both)
        solid = float(secondary.material.solid_fraction_at(secondary.temperature(self._trial)))
        return Faces.at_temperatures(hot, cold, self._trial, solid)

    def commit(self) -> None:
        """Accept the trial temperatures."""
        self._time = self._trial

    def rewind(self) -> None:
        """Return to the temperatures of the last commit."""
        self._set(self._time)

    def saved(self) -> dict[str, Saved]:
        """Return the time of the present temperatures [s]."""
        return {"time": number(self._time, of_cycle=True)}

    def restore(self, arrays: Arrays) -> None:
        """Restore the time of the present temperatures [s]."""
        self._time = float(arrays["time"])
        self._set(self._time)

    def begin_stage(self) -> None:
        """Do nothing: the temperatures depend on time alone."""

    def totals(self) -> dict[str, float]:
        """Return no totals: nothing is exchanged."""
        return {}

    def destroy(self) -> None:
        """Do nothing: there is no PETSc object."""
