"""One thermo-mechanical step: heat, equilibrium, new gaps, until the interfaces agree.

The unknown of the passes is the thermal resistance R = 1/h of every pair, which is linear in an
open gap. Aitken's factor on R breaks the two-cycle into which the plain iteration falls at large
steps; the first guess comes from the gap extrapolated in time. Where h depends on temperature too,
the R that were tried and found are compared at the temperatures of the pass, and heat is given the
gap and pressure found with the factor that turns their R into the wanted one; radiation takes no
part, since neither gap nor pressure change it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.coupling.dissipation import Dissipation
from castx.coupling.interface import CoupledInterface, InterfaceState
from castx.coupling.relaxation import Relaxation, scaled
from castx.coupling.report import CoupledReport
from castx.coupling.temperatures import Temperatures
from castx.equilibrium.problem import MechanicalProblem
from castx.errors import ConvergenceError
from castx.solvers.diagnosis import COUPLING
from castx.solvers.finite import require_finite
from castx.stateful import (
    Arrays,
    Saved,
    Stateful,
    joined,
    number,
    part_of,
    restore_parts,
    saved_parts,
)
from castx.transfer.conductance import PairState

ROUNDING = 1e-12
"""Part of the heat that bodies hold below which none moves: the end of a run stands still."""


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
        felt = mechanics.bodies if mechanics and scheme in ("staggered", "iterated") else {}
        self._dissipation = Dissipation(comm, felt)
        self.states = self._initial_states()
        self._initial = [state.felt for state in self.states]
        self._committed = list(self.states)
        self._gap_rates: list[FloatArray] = [np.zeros(len(s.gap)) for s in self.states]
        self._solid_fraction, self._heat = self._present_solid_fraction(), self._stored_heat()
        # Nothing has moved yet, so that any step gives the stress of the initial state.
        self._step = self._committed_step = 1.0
        self._update_bodies(self._step)

    def _present_solid_fraction(self) -> FloatArray:
        parts = [function.x.array for function in self.heat.solid_fraction.values()]
        return np.concatenate(parts)

    def _initial_states(self) -> list[InterfaceState]:
        gaps = [interface.initial_gap.copy() for interface in self.interfaces]
        pairs = [PairState.of(gap, np.zeros(len(gap))) for gap in gaps]
        forces = [np.zeros_like(i.pairs.area_vectors) for i in self.interfaces]
        return [
            InterfaceState(gap, state.pressure, resistance, gap <= 0, force)
            for gap, state, resistance, force in zip(
                gaps, pairs, self.heat.resistances(pairs), forces, strict=True
            )
        ]

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
            total = total.followed_by(self._pass(time, step, substeps, guess))
            felt = self._felt(self.states)
            found = self.heat.resistances(felt)
            self.states = [
                replace(state, resistance=resistance)
                for state, resistance in zip(self.states, found, strict=True)
            ]
            tried = _concatenated(self.heat.resistances(guess))
            change = _largest_change(self.comm, _concatenated(found), tried)
            change = max(change, self._dissipation_change(step))
            if self._scheme != "iterated" or change <= self._tolerance:
                self._require_finite()
                return replace(total, solid_fraction_change=self._solid_fraction_change())
            wanted = relaxation.next(tried, _concatenated(found))
            guess = scaled(felt, found, wanted)
        raise ConvergenceError(
            f"the interfaces did not agree in {self._most_passes} passes (coupling.passes): the "
            f"resistance of some pair still changes by {change:.2g} of its value",
            COUPLING,
        )

    def _require_finite(self) -> None:
        moving = {} if self.mechanics is None else self.mechanics.bodies
        motions = {name: body.solution for name, body in moving.items()}
        require_finite(self.comm, {"temperature": self.heat.temperature, "motion": motions})

    def _felt(self, states: Sequence[InterfaceState]) -> list[PairState]:
        """Return what heat feels of the states of the interfaces."""
        if self._scheme in ("staggered", "iterated"):
            return [state.felt for state in states]
        return self._initial

    def _first_guess(self, step: float) -> list[PairState]:
        if self._scheme != "iterated":
            return self._felt(self._committed)
        return [
            PairState.of(state.felt.gap + step * rate, state.pressure)
            for state, rate in zip(self._committed, self._gap_rates, strict=True)
        ]

    def _pass(
        self, time: float, step: float, substeps: int, guess: Sequence[PairState]
    ) -> CoupledReport:
        both = list(zip(self._felt(self._committed), guess, strict=True))
        report = self.heat.advance(time, step, both, substeps, self._dissipation.powers)
        heat = CoupledReport(
            1, report.iterations, temperature_change=report.largest_temperature_change
        )
        if self.mechanics is None:
            return heat
        self._update_bodies(step)
        found = self.mechanics.equilibrium.solve(time + step)
        self._read_interfaces()
        equilibrium = self.mechanics.equilibrium
        return replace(
            heat,
            mechanics_iterations=found.iterations,
            linear_iterations=found.linear_iterations,
            contact_changes=found.contact_changes,
            frozen_pairs=equilibrium.active.frozen_pairs(),
            unbalanced=int(not found.balanced),
            fallbacks=equilibrium.fallbacks,
        )

    def _dissipation_change(self, step: float) -> float:
        """Return the change of the plastic heat of the step, relative to all heat that it moves."""
        change = step * self._dissipation.update()
        local = [np.abs(self._stored_heat() - self._heat).sum(), np.abs(self._heat).sum()]
        moved, held = self.comm.allreduce(np.array(local), op=MPI.SUM)
        moved = max(float(moved), ROUNDING * float(held), change)
        return change / moved if moved > 0 else 0.0

    def _stored_heat(self) -> FloatArray:
        """Return the enthalpies of the owned nodes [J], of none without the heat equation."""
        parts = [
            self.volumes[name] * function.x.array[: len(self.volumes[name])]
            for name, function in self.heat.enthalpy.items()
        ]
        return _concatenated(parts)

    def _update_bodies(self, step: float) -> None:
        if self.mechanics is not None:
            for name, body in self.mechanics.bodies.items():
                temperature = self.heat.temperature[name].x.array
                body.update_state(temperature, self.heat.solid_fraction[name].x.array, step)

    def _read_interfaces(self) -> None:
        assert self.mechanics is not None
        contacts = self.mechanics.contact_states()
        for i, interface in enumerate(self.interfaces):
            if interface.contact is None:
                continue
            found = contacts[interface.contact]
            self.states[i] = replace(
                self.states[i], gap=found.gap, pressure=found.pressure, closed=found.closed,
                force=found.vectors,
            )  # fmt: skip

    def _solid_fraction_change(self) -> float:
        change = np.abs(self._present_solid_fraction() - self._solid_fraction)
        return float(self.comm.allreduce(float(change.max(initial=0.0)), op=MPI.MAX))

    def contact_force_vectors(self, name: str) -> FloatArray:
        """Return the forces on an interface's secondary nodes [N], shape (pairs, dimension)."""
        names = [interface.name for interface in self.interfaces]
        return self.states[names.index(name)].force

    def commit(self) -> None:
        """Make the trial state the one from which the next step starts."""
        self._gap_rates = [
            np.asarray((new.felt.gap - old.felt.gap) / self._step, dtype=np.float64)
            for new, old in zip(self.states, self._committed, strict=True)
        ]
        self._committed, self._committed_step = list(self.states), self._step
        self.heat.commit()
        self._dissipation.commit()
        self._solid_fraction, self._heat = self._present_solid_fraction(), self._stored_heat()
        if self.mechanics is not None:
            self.mechanics.equilibrium.commit()

    def rewind(self) -> None:
        """Return to the committed state."""
        self.states = list(self._committed)
        self.heat.rewind()
        self._dissipation.rewind()
        self._update_bodies(self._committed_step)
        if self.mechanics is not None:
            self.mechanics.equilibrium.rewind()

    def saved(self) -> dict[str, Saved]:
        """Return the committed state as arrays; collective."""
        return joined({"interfaces": self._saved_interfaces()}) | saved_parts(self._parts())

    def _parts(self) -> dict[str, Stateful]:
        parts: dict[str, Stateful] = {"heat": self.heat, "dissipation": self._dissipation}
        return parts if self.mechanics is None else parts | {"mechanics": self.mechanics.memory}

    def _saved_interfaces(self) -> dict[str, Saved]:
        found = {"step": number(self._committed_step)}
        for interface, state, rate in zip(
            self.interfaces, self._committed, self._gap_rates, strict=True
        ):
            for name, values in {**vars(state), "gap_rate": rate}.items():
                found[f"{interface.name}/{name}"] = Saved(values, interface.pairs.numbering)
        return found

    def restore(self, arrays: Arrays) -> None:
        """Take back a state as the committed one; collective."""
        own = part_of(arrays, "interfaces")
        self._committed_step = float(own["step"])
        states = [part_of(own, interface.name) for interface in self.interfaces]
        self._gap_rates = [state.pop("gap_rate") for state in states]
        self._committed = [InterfaceState(**state) for state in states]
        restore_parts(self._parts(), arrays)
        self.rewind()
        self._solid_fraction, self._heat = self._present_solid_fraction(), self._stored_heat()

    def begin_stage(self, renewed: Collection[str]) -> None:
        """Start a stage with the committed state; collective.

        Args:
            renewed: names of the bodies that are new.
        """
        self.heat.begin_stage()
        if self.mechanics is not None:
            self.mechanics.memory.begin_stage(renewed)
        self.rewind()
        self._solid_fraction, self._heat = self._present_solid_fraction(), self._stored_heat()

    def destroy(self) -> None:
        """Free what PETSc holds."""
        self.heat.destroy()
        if self.mechanics is not None:
            self.mechanics.destroy()


def _largest_change(comm: MPI.Intracomm, found: FloatArray, tried: FloatArray) -> float:
    compared = np.isfinite(found) & np.isfinite(tried) & (found > 0)
    change = np.abs(found[compared] - tried[compared]) / found[compared]
    if (np.isfinite(found) != np.isfinite(tried)).any():
        change = np.array([np.inf])
    return float(comm.allreduce(float(change.max(initial=0.0)), op=MPI.MAX))


def _concatenated(parts: Sequence[FloatArray]) -> FloatArray:
    return np.concatenate([np.zeros(0), *parts])
