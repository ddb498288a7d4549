"""One thermo-mechanical step: heat, equilibrium, new gaps, until the interfaces agree.

The unknown of the passes is the thermal resistance R = 1/h of every pair, which is linear in an
open gap. Aitken's factor on R breaks the two-cycle into which the plain iteration falls at large
steps; the first guess comes from the gap extrapolated in time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from mpi4py import MPI

import numpy as np
from dolfinx import fem

from castx.coupled_interface import CoupledInterface, InterfaceState
from castx.errors import ConvergenceError
from castx.heat import HeatReport
from castx.mechanical_problem import MechanicalProblem
from castx.relaxation import Relaxation
from castx.tables import FloatArray


class Temperatures(Protocol):
    """The heat problem of all bodies, or what stands in its place."""

    temperature: dict[str, fem.Function]
    enthalpy: dict[str, fem.Function]
    solid_fraction: dict[str, fem.Function]

    def advance(
        self,
        time: float,
        step: float,
        resistances: Sequence[tuple[FloatArray, FloatArray] | None] = (),
        substeps: int = 1,
    ) -> HeatReport:
        """Find the trial state at the end of a step."""

    def commit(self) -> None:
        """Make the trial state the one from which the next step starts."""

    def rewind(self) -> None:
        """Return to the committed state."""

    def totals(self) -> dict[str, float]:
        """Return the committed totals of heat by name."""

    def destroy(self) -> None:
        """Free what PETSc holds."""


@dataclass(frozen=True)
class CoupledReport:
    """What one coupled step took.

    Attributes:
        passes: solutions of heat and mechanics.
        heat_iterations: Newton iterations of the heat problem, all passes.
        mechanics_iterations: those of the equilibrium.
        linear_iterations: linear iterations of the equilibrium.
        contact_changes: pairs that opened or closed.
        temperature_change: of the fastest node [K].
        solid_fraction_change: likewise.
    """

    passes: int = 0
    heat_iterations: int = 0
    mechanics_iterations: int = 0
    linear_iterations: int = 0
    contact_changes: int = 0
    temperature_change: float = 0.0
    solid_fraction_change: float = 0.0


class CoupledProblem:
    """Heat and mechanics of all bodies, committed and trial.

    Args:
        comm: ranks.
        heat: temperatures of all bodies.
        mechanics: the equilibrium; None: thermal only.
        interfaces: all interfaces of the heat problem, in its order.
        volumes: of the owned nodes of each body [m³].
        scheme: "thermal", "mechanical", "one-way", "staggered" or "iterated".
        tolerance: relative change of every resistance between the last two passes.
        most_passes: passes after which the step has failed.
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        heat: Temperatures,
        mechanics: MechanicalProblem | None,
        interfaces: Sequence[CoupledInterface],
        volumes: Mapping[str, FloatArray],
        scheme: str,
        tolerance: float,
        most_passes: int,
    ) -> None:
        self.comm, self.heat, self.mechanics = comm, heat, mechanics
        self.interfaces, self.volumes = list(interfaces), dict(volumes)
        self._scheme, self._tolerance, self._most_passes = scheme, tolerance, most_passes
        self.states = [self._initial_state(interface) for interface in self.interfaces]
        self._committed = list(self.states)
        self._gap_rates: list[FloatArray] = [np.zeros(len(s.gap)) for s in self.states]
        self._solid_fraction = self._present_solid_fraction()
        # Nothing has moved yet, so that any step gives the stress of the initial state.
        self._step = self._committed_step = 1.0
        self._update_bodies(self._step)

    def _present_solid_fraction(self) -> FloatArray:
        parts = [function.x.array for function in self.heat.solid_fraction.values()]
        return np.concatenate(parts)

    def _initial_state(self, interface: CoupledInterface) -> InterfaceState:
        gap = interface.initial_gap.copy()
        pressure = np.zeros(len(gap))
        return InterfaceState(gap, pressure, interface.resistance(gap, pressure), gap <= 0)

    def advance(self, time: float, step: float, substeps: int) -> CoupledReport:
        """Find the trial state at the end of a step that starts from the committed state.

        Args:
            time: start of the step [s].
            step: its size [s].
            substeps: steps of the heat problem inside it.

        Raises:
            ConvergenceError: a problem or the passes did not converge; `rewind` then.
        """
        self._step = step
        guess = self._first_guess(step)
        relaxation = Relaxation(self.comm)
        total = CoupledReport()
        for _ in range(self._most_passes):
            total = _sum(total, self._pass(time, step, substeps, guess))
            found = self._concatenated([state.resistance for state in self.states])
            tried = self._concatenated(guess)
            change = _largest_change(self.comm, found, tried)
            if self._scheme != "iterated" or change <= self._tolerance:
                return replace(total, solid_fraction_change=self._solid_fraction_change())
            guess = self._split(relaxation.next(tried, found))
        raise ConvergenceError(
            f"the interfaces did not agree in {self._most_passes} passes (coupling.passes): the "
            f"resistance of some pair still changes by {change:.2g} of its value"
        )

    def _first_guess(self, step: float) -> list[FloatArray]:
        if self._scheme != "iterated":
            return [state.resistance for state in self._committed]
        guesses = []
        for interface, state, rate in zip(
            self.interfaces, self._committed, self._gap_rates, strict=True
        ):
            guesses.append(interface.resistance(state.gap + step * rate, state.pressure))
        return guesses

    def _pass(
        self, time: float, step: float, substeps: int, resistance: Sequence[FloatArray]
    ) -> CoupledReport:
        both = [
            (start.resistance, end) if interface.exchanges else None
            for interface, start, end in zip(
                self.interfaces, self._committed, resistance, strict=True
            )
        ]
        report = self.heat.advance(time, step, both, substeps)
        heat = CoupledReport(
            1, report.iterations, temperature_change=report.largest_temperature_change
        )
        if self.mechanics is None:
            return heat
        self._update_bodies(step)
        found = self.mechanics.equilibrium.solve(time + step)
        self._read_interfaces()
        return CoupledReport(
            1, heat.heat_iterations, found.iterations, found.linear_iterations,
            found.contact_changes, heat.temperature_change,
        )

    def _update_bodies(self, step: float) -> None:
        if self.mechanics is not None:
            for name, body in self.mechanics.bodies.items():
                temperature = self.heat.temperature[name].x.array
                body.update_state(temperature, self.heat.solid_fraction[name].x.array, step)

    def _read_interfaces(self) -> None:
        assert self.mechanics is not None
        gaps, forces = self.mechanics.equilibrium.pair_values()
        closed = self.mechanics.equilibrium.active.closed
        areas = self.mechanics.gaps.areas
        # The last digits of a closed pair without pressure may pull.
        pushes = np.maximum(forces, 0.0)
        pressures = np.divide(pushes, areas, out=np.zeros_like(forces), where=areas > 0)
        feedback = self._scheme in ("staggered", "iterated")
        for i, interface in enumerate(self.interfaces):
            if interface.contact is None:
                continue
            part = self.mechanics.gaps.slices[interface.contact]
            gap, pressure = gaps[part], pressures[part]
            resistance = interface.resistance(gap, pressure)
            if not feedback:
                resistance = self._committed[i].resistance
            self.states[i] = InterfaceState(gap, pressure, resistance, closed[part].copy())

    def _solid_fraction_change(self) -> float:
        change = np.abs(self._present_solid_fraction() - self._solid_fraction)
        return float(self.comm.allreduce(float(change.max(initial=0.0)), op=MPI.MAX))

    def _concatenated(self, parts: Sequence[FloatArray]) -> FloatArray:
        return np.concatenate([np.zeros(0), *parts])

    def _split(self, values: FloatArray) -> list[FloatArray]:
        ends = np.cumsum([len(state.gap) for state in self.states])
        return list(np.split(values, ends[:-1])) if len(ends) else []

    def contact_force_vectors(self, name: str) -> FloatArray:
        """Return the forces on an interface's secondary nodes [N], shape (pairs, dimension)."""
        names = [interface.name for interface in self.interfaces]
        index = names.index(name)
        contact, pairs = self.interfaces[index].contact, self.interfaces[index].pairs
        if contact is None or self.mechanics is None:
            return np.zeros_like(pairs.area_vectors)
        placed = self.mechanics.gaps.interfaces[contact]
        force = self.states[index].pressure * placed.areas
        return np.asarray(force[:, None] * placed.normals)

    def commit(self) -> None:
        """Make the trial state the one from which the next step starts."""
        self._gap_rates = [
            np.asarray((new.gap - old.gap) / self._step, dtype=np.float64)
            for new, old in zip(self.states, self._committed, strict=True)
        ]
        self._committed, self._committed_step = list(self.states), self._step
        self.heat.commit()
        self._solid_fraction = self._present_solid_fraction()
        if self.mechanics is not None:
            self.mechanics.equilibrium.commit()

    def rewind(self) -> None:
        """Return to the committed state."""
        self.states = list(self._committed)
        self.heat.rewind()
        self._update_bodies(self._committed_step)
        if self.mechanics is not None:
            self.mechanics.equilibrium.rewind()

    def destroy(self) -> None:
        """Free what PETSc holds."""
        self.heat.destroy()
        if self.mechanics is not None:
            self.mechanics.equilibrium.destroy()


def _largest_change(comm: MPI.Intracomm, found: FloatArray, tried: FloatArray) -> float:
    compared = np.isfinite(found) & np.isfinite(tried) & (found > 0)
    change = np.abs(found[compared] - tried[compared]) / found[compared]
    if (np.isfinite(found) != np.isfinite(tried)).any():
        change = np.array([np.inf])
    return float(comm.allreduce(float(change.max(initial=0.0)), op=MPI.MAX))


def _sum(a: CoupledReport, b: CoupledReport) -> CoupledReport:
    return CoupledReport(
        a.passes + b.passes,
        a.heat_iterations + b.heat_iterations,
        a.mechanics_iterations + b.mechanics_iterations,
        a.linear_iterations + b.linear_iterations,
        a.contact_changes + b.contact_changes,
        b.temperature_change,
    )
