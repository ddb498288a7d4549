"""Foundry quantities of solidification: local solidification time, gradient, cooling rate, Niyama.

Every node of a body that melts is followed through its enthalpy, which falls linearly within a step
of implicit Euler. Crossing times are interpolated on the enthalpy: they are right on the plateau of
an isothermal change too, where the temperature says nothing. When a node passes liquidus and
solidus themselves is smeared by an element, because its enthalpy is the mean around it and changes
its pace there; both times are extrapolated from f_s = 0.02, 0.04 and 0.96, 0.98, which on case V3
halves the error of the local solidification time.

The cooling rate is that of a node which the surface f_s = 0.9 passes with the speed v: Ṫ = G v with
v = 1/|∇t|, t the time of passing (W. Kurz and D. J. Fisher, Fundamentals of Solidification, 1998,
ch. 1). That surface is an isotherm, so nothing else is meant than -∂T/∂t; but this form exists for
an isothermal change as well and is smooth where the history of a single node has stairs. On case V3
it is right to 1 % at 10 elements behind the wall, ∂T/∂t of the node to 10 %.

Niyama criterion: E. Niyama, T. Uchida, M. Morikawa and S. Saito, A method of shrinkage prediction
and its application to steel casting practice, AFS Int. Cast Metals J. 7 (1982) 52-63.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np

from castx.arrays import FloatArray
from castx.results.gradients import Steepness
from castx.results.snapshot import Snapshot
from castx.stateful import Arrays, Saved, number, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import BodyMesh, CastingMesh

NIYAMA_FRACTION = 0.9
LEVELS = (0.02, 0.04, NIYAMA_FRACTION, 0.96, 0.98)
"""Solid fractions whose passing is noted."""

COLDEST, HOTTEST = -273.15, 1e4
"""Temperatures between which every metal freezes [°C]."""
QUANTITIES = ("solidification_time", "gradient", "cooling_rate", "niyama")


class FreezingCurve(Protocol):
    """The part of a material's enthalpy curve that is needed here."""

    def enthalpy(self, temperature: FloatArray) -> FloatArray:
        """Return enthalpies per volume [J/m³] at temperatures [°C]."""

    def solid_fraction(self, enthalpy: FloatArray) -> FloatArray:
        """Return solid fractions at enthalpies per volume [J/m³]."""


def thresholds_of(curve: FreezingCurve) -> FloatArray:
    """Return the enthalpies per volume [J/m³] at which a material that melts reaches `LEVELS`."""
    coldest, hottest = (float(curve.enthalpy(np.array(bound))) for bound in (COLDEST, HOTTEST))

    def highest(level: float) -> float:
        """Return the highest enthalpy with at least this solid fraction, by bisection."""
        low, high = coldest, hottest
        while (middle := 0.5 * (low + high)) not in (low, high):
            solid = float(curve.solid_fraction(np.array(middle))) >= level
            low, high = (middle, high) if solid else (low, middle)
        return low

    return np.array([highest(level) for level in LEVELS])


@dataclass(frozen=True)
class _Instant:
    time: float
    enthalpy: FloatArray
    gradient: FloatArray


class BodySolidification:
    """The solidification of one body, followed step by step.

    Args:
        body: its mesh.
        thresholds: those of its material.
    """

    def __init__(self, body: BodyMesh, thresholds: FloatArray) -> None:
        self._thresholds = thresholds
        self._steepness = Steepness(body)
        nodes = body.nodes.dofmap.index_map.size_local + body.nodes.dofmap.index_map.num_ghosts
        self._times = np.full((len(LEVELS), nodes), np.nan)
        self._gradient = np.full(nodes, np.nan)
        self._old = self._first = _Instant(np.nan, np.zeros(nodes), np.zeros(nodes))
        self._numbering = body.node_numbering

    def update(self, snapshot: Snapshot, body: str) -> None:
        """Take over the state after an accepted step; collective."""
        new = _Instant(
            time=snapshot.time,
            enthalpy=snapshot.nodal(body, "enthalpy").copy(),
            gradient=self._temperature_gradient(
                snapshot.nodal(body, "temperature"), snapshot.nodal(body, "solid_fraction")
            ),
        )
        if body in snapshot.process.renewed:
            self._times[:], self._gradient[:] = np.nan, np.nan
            filled = snapshot.time - snapshot.counters.step
            self._begin(replace(self._first, time=filled))
        if np.isnan(self._old.time):
            self._first = new
            self._begin(new)
        else:
            self._pass(self._old, new)
        self._old = new

    def _begin(self, new: _Instant) -> None:
        """Note the levels that a body has already passed when it begins."""
        solid = new.enthalpy <= self._thresholds[-1]
        passed = new.enthalpy <= self._thresholds[:, None]
        self._times[passed & ~solid] = new.time
        self._old = new

    def saved(self) -> dict[str, Saved]:
        """Return the times of passing so far, the last state and the first one."""
        old = self._old
        found = {
            "times": self._times.T.copy(),
            "gradient": self._gradient,
            "last_enthalpy": old.enthalpy,
            "last_gradient": old.gradient,
            "first_enthalpy": self._first.enthalpy,
            "first_gradient": self._first.gradient,
        }
        nodal = {name: Saved(values, self._numbering) for name, values in found.items()}
        return {"time": number(old.time), "first_time": number(self._first.time), **nodal}

    def restore(self, arrays: Arrays) -> None:
        """Restore the times of passing, the last state and the first one."""
        self._times = np.ascontiguousarray(arrays["times"].T)
        self._gradient = arrays["gradient"]
        self._old = _Instant(
            float(arrays["time"]), arrays["last_enthalpy"], arrays["last_gradient"]
        )
        self._first = _Instant(
            float(arrays["first_time"]), arrays["first_enthalpy"], arrays["first_gradient"]
        )

    def _pass(self, old: _Instant, new: _Instant) -> None:
        """Note the levels passed between two instants; remelting deletes those it passes."""
        for level, threshold, times in zip(LEVELS, self._thresholds, self._times, strict=True):
            times[(old.enthalpy <= threshold) & (new.enthalpy > threshold)] = np.nan
            passed = (old.enthalpy > threshold) & (new.enthalpy <= threshold)
            part = (old.enthalpy[passed] - threshold) / (old.enthalpy - new.enthalpy)[passed]
            times[passed] = old.time + part * (new.time - old.time)
            if level == NIYAMA_FRACTION:
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

    @property
    def _passing(self) -> FloatArray:
        """Time at which f_s = 0.9 was passed [s]."""
        return np.asarray(self._times[LEVELS.index(NIYAMA_FRACTION)])

    def solidification_time(self) -> FloatArray:
        """Return the time between liquidus and solidus [s], extrapolated from either side."""
        first, second, _, last_but_one, last = self._times
        return (2.0 * last - last_but_one) - (2.0 * first - second)

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

    def __init__(self, mesh: CastingMesh, thresholds: Mapping[str, FloatArray]) -> None:
        self._mesh = mesh
        self._bodies = {
            name: BodySolidification(mesh.bodies[name], known) for name, known in thresholds.items()
        }

    def update(self, snapshot: Snapshot) -> None:
        """Take over the state after an accepted step; collective."""
        for name, body in self._bodies.items():
            if name in snapshot.mesh.bodies:
                body.update(snapshot, name)

    def saved(self) -> dict[str, Saved]:
        """Return the state of all bodies; collective."""
        return saved_parts(self._bodies)

    def restore(self, arrays: Arrays) -> None:
        """Restore the state of each body; one that was not followed begins now."""
        for name, body in self._bodies.items():
            if part := part_of(arrays, name):
                body.restore(part)

    def nodal(self, body: str, quantity: str) -> FloatArray:
        """Return one of `QUANTITIES` at the nodes of a body, ghosts included: (nodes,); collective.

        Not a number where it does not exist yet, and everywhere in a body that does not melt.
        """
        if body not in self._bodies:
            index_map = self._mesh.bodies[body].nodes.dofmap.index_map
            return np.full(index_map.size_local + index_map.num_ghosts, np.nan)
        values: FloatArray = getattr(self._bodies[body], quantity)()
        return values
