"""Foundry quantities of solidification: local solidification time, gradient, cooling rate, Niyama.

Every node of a body that melts is followed through its enthalpy, which falls linearly within a step
of implicit Euler. Crossing times are interpolated on the enthalpy: they are right on the plateau of
an isothermal change too, where the temperature says nothing.

The cooling rate is that of a node which the surface f_s = 0.9 passes with the speed v: Ṫ = G v with
v = 1/|∇t|, t the time of passing (W. Kurz and D. J. Fisher, Fundamentals of Solidification, 1998,
ch. 1). That surface is an isotherm, so nothing else is meant than -∂T/∂t; but this form exists for
an isothermal change as well and is smooth where the history of a single node has stairs. On case V3
it is right to 1 % at 10 elements behind the wall, ∂T/∂t of the node to 10 %.

Niyama criterion: E. Niyama, T. Uchida, M. Morikawa and S. Saito, A method of shrinkage prediction
and its application to steel casting practice, AFS Int. Cast Metals J. 7 (1982) 52-63.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from castx.gradients import Steepness
from castx.snapshot import Snapshot
from castx.tables import FloatArray

if TYPE_CHECKING:
    from castx.mesh import BodyMesh, CastingMesh

NIYAMA_FRACTION = 0.9
COLDEST, HOTTEST = -273.15, 1e4
"""Temperatures between which every metal freezes [°C]."""
QUANTITIES = ("solidification_time", "gradient", "cooling_rate", "niyama")


class EnthalpyCurve(Protocol):
    """The part of a material's enthalpy curve that is needed here."""

    def enthalpy(self, temperature: FloatArray) -> FloatArray:
        """Return enthalpies per volume [J/m³] at temperatures [°C]."""

    def solid_fraction(self, enthalpy: FloatArray) -> FloatArray:
        """Return solid fractions at enthalpies per volume [J/m³]."""


@dataclass(frozen=True)
class Thresholds:
    """Enthalpies per volume [J/m³] that a freezing material passes.

    Args:
        start: where the first solid appears.
        niyama: where f_s = 0.9 is reached.
        end: where the last liquid has gone.
    """

    start: float
    niyama: float
    end: float

    @classmethod
    def of(cls, curve: EnthalpyCurve) -> Thresholds:
        """Return the thresholds of a material that melts."""
        low, high = (float(curve.enthalpy(np.array(bound))) for bound in (COLDEST, HOTTEST))

        def lowest(holds: Callable[[float], bool]) -> float:
            """Return where a condition that holds at all high enthalpies begins to hold."""
            below, above = low, high
            while (middle := 0.5 * (below + above)) not in (below, above):
                below, above = (below, middle) if holds(middle) else (middle, above)
            return above

        def fraction(enthalpy: float) -> float:
            return float(curve.solid_fraction(np.array(enthalpy)))

        return cls(
            start=lowest(lambda enthalpy: fraction(enthalpy) <= 0.0),
            niyama=lowest(lambda enthalpy: fraction(enthalpy) < NIYAMA_FRACTION),
            end=lowest(lambda enthalpy: fraction(enthalpy) < 1.0),
        )


@dataclass(frozen=True)
class _Instant:
    time: float
    enthalpy: FloatArray
    gradient: FloatArray


class BodySolidification:
    """The solidification of one body, followed step by step; times in seconds, NaN where not yet.

    Args:
        body: its mesh.
        thresholds: those of its material.
    """

    def __init__(self, body: BodyMesh, thresholds: Thresholds) -> None:
        self._thresholds = thresholds
        self._steepness = Steepness(body)
        nodes = body.nodes.dofmap.index_map.size_local + body.nodes.dofmap.index_map.num_ghosts
        self._start, self._passing, self._end, self._gradient = np.full((4, nodes), np.nan)
        self._old: _Instant | None = None

    def update(self, snapshot: Snapshot, body: str) -> None:
        """Take over the state after an accepted step; collective."""
        new = _Instant(
            time=snapshot.time,
            enthalpy=snapshot.nodal(body, "enthalpy").copy(),
            gradient=self._temperature_gradient(
                snapshot.nodal(body, "temperature"), snapshot.nodal(body, "solid_fraction")
            ),
        )
        if self._old is None:
            self._start[new.enthalpy <= self._thresholds.start] = new.time
            self._start[new.enthalpy <= self._thresholds.end] = np.nan
        else:
            self._pass(self._old, new)
        self._old = new

    def _pass(self, old: _Instant, new: _Instant) -> None:
        """Note what was passed between two instants; melting again wipes what it passes."""
        for times, threshold in (
            (self._start, self._thresholds.start),
            (self._passing, self._thresholds.niyama),
            (self._end, self._thresholds.end),
        ):
            times[(old.enthalpy <= threshold) & (new.enthalpy > threshold)] = np.nan
            passed = (old.enthalpy > threshold) & (new.enthalpy <= threshold)
            part = (old.enthalpy[passed] - threshold) / (old.enthalpy - new.enthalpy)[passed]
            times[passed] = old.time + part * (new.time - old.time)
            if times is self._passing:
                self._gradient[passed] = (1.0 - part) * old.gradient[passed]
                self._gradient[passed] += part * new.gradient[passed]

    def _temperature_gradient(
        self, temperature: FloatArray, solid_fraction: FloatArray
    ) -> FloatArray:
        """Return |∇T| at the nodes [K/m], seen from the solid.

        The gradient jumps at the front of an isothermal change; cells count with their solid
        fraction, and liquid ones only where there is nothing else.
        """
        solid = solid_fraction[self._steepness.cell_nodes].mean(axis=1)
        return self._steepness.at_nodes(self._steepness.in_cells(temperature), solid + 1e-6)

    def solidification_time(self) -> FloatArray:
        """Return the time between passing liquidus and solidus [s]."""
        return self._end - self._start

    def gradient(self) -> FloatArray:
        """Return |∇T| when f_s = 0.9 was passed [K/m]."""
        return np.where(np.isfinite(self._passing), self._gradient, np.nan)

    def cooling_rate(self) -> FloatArray:
        """Return Ṫ = G v when f_s = 0.9 was passed, positive on cooling [K/s]; collective."""
        in_cells = self._steepness.in_cells(self._passing)
        slowness = self._steepness.at_nodes(in_cells, np.isfinite(in_cells).astype(np.float64))
        with np.errstate(divide="ignore"):
            return self.gradient() / slowness

    def niyama(self) -> FloatArray:
        """Return G/√Ṫ when f_s = 0.9 was passed [K^½ s^½/m]; collective."""
        return self.gradient() / np.sqrt(self.cooling_rate())


class Solidification:
    """The foundry quantities of all bodies that melt.

    Args:
        mesh: the bodies.
        thresholds: those of the bodies that melt, by name.
    """

    def __init__(self, mesh: CastingMesh, thresholds: Mapping[str, Thresholds]) -> None:
        self._mesh = mesh
        self._bodies = {
            name: BodySolidification(mesh.bodies[name], known) for name, known in thresholds.items()
        }

    def update(self, snapshot: Snapshot) -> None:
        """Take over the state after an accepted step; collective."""
        for name, body in self._bodies.items():
            body.update(snapshot, name)

    def nodal(self, body: str, quantity: str) -> FloatArray:
        """Return one of `QUANTITIES` at the nodes of a body, ghosts included: (nodes,); collective.

        Not a number where it does not exist yet, and everywhere in a body that does not melt.
        """
        if body not in self._bodies:
            index_map = self._mesh.bodies[body].nodes.dofmap.index_map
            return np.full(index_map.size_local + index_map.num_ghosts, np.nan)
        values: FloatArray = getattr(self._bodies[body], quantity)()
        return values
