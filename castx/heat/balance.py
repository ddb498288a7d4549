"""Discrete balance of heat of all bodies over one implicit Euler step."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.heat.body import ThermalBody
from castx.heat.boundaries import SurfaceFlux, SurfaceTemperature
from castx.heat.interface import HeatExchange
from castx.heat.interfaces import Exchanges
from castx.heat.jacobian import HeatJacobian
from castx.heat.perfect_contact import Bonds, gather_links
from castx.solvers.layout import Layout
from castx.transfer.pair_state import PairState

ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
"""Balance below which the residual is round-off, relative to the terms that cancel in it."""


@dataclass(frozen=True)
class Balance:
    """Sums over all nodes at the last residual [W].

    Attributes:
        residual: of the absolute values of the residual.
        moved: heat that changes place: the larger of storage and of the flows between bodies and
            through surfaces.
        rounding: what round-off may leave of the residual.
    """

    residual: float
    moved: float
    rounding: float


class HeatSystem:
    """Residual [W] and Jacobian of all nodal balances in the nodal enthalpies.

        V_i (H_i − H_i^n)/Δt + Σ_j L_ij θ_j − sources − surfaces ± exchange = 0

    Sources and surroundings enter by their means over the step, temperatures by those at its end.
    The unknown of a node is its enthalpy H_i [J/m³]; bonded nodes share the mean enthalpy of their
    group at the place of its first node, and the other places are idle.

    Args:
        layout: numbering of the nodes of all bodies.
        bodies: in the order of the layout.
        exchanges: interfaces.
        fluxes: conditions that give a flux.
        temperatures: conditions that give a temperature; where two meet, the first holds.
    """

    def __init__(
        self,
        layout: Layout,
        bodies: Sequence[ThermalBody],
        exchanges: Sequence[HeatExchange],
        fluxes: Sequence[SurfaceFlux],
        temperatures: Sequence[SurfaceTemperature],
    ) -> None:
        self.layout = layout
        self.bodies = tuple(bodies)
        self.fluxes = tuple(fluxes)
        self.temperatures = tuple(temperatures)
        self._interfaces = len(exchanges)
        self._parts = [layout.local_slice(k) for k in range(len(bodies))]
        self.time, self.step = 0.0, 1.0
        self._create_vectors()
        self._create_exchanges(exchanges)
        self._create_prescribed()
        self.jacobian = HeatJacobian(
            layout, self.bodies, self.exchanges.under_law, self.bonds
        )

    def _create_vectors(self) -> None:
        create = self.layout.create_vector
        self.residual = create()
        self._balance, self._enthalpy, self._slope = create(), create(), create()
        self._temperature, self._temperature_slope = create(), create()
        self._wanted, self._reaction = create(), create()
        self.volumes = np.concatenate([body.volumes for body in self.bodies])
        self.previous = self.enthalpy()
        self.dissipation: FloatArray = np.zeros(self.layout.size_local)

    def _create_exchanges(self, exchanges: Sequence[HeatExchange]) -> None:
        self.exchanges = Exchanges(self.layout, self._balance, self.bodies, exchanges)
        names = [body.name for body in self.bodies]
        links = gather_links(self.layout.comm, self.layout, names, exchanges)
        self.bonds: Bonds | None = None
        if len(links.dofs):
            self._balance.array[:] = self.volumes
            self.bonds = Bonds(links, len(exchanges), self.bodies, self._balance)

    def _create_prescribed(self) -> None:
        """Find the unknowns that do not solve a balance, and whose temperature the user gives."""
        self._giver = np.full(self.layout.size_local, -1)
        for number, condition in reversed(list(enumerate(self.temperatures))):
            self._giver[self._start_of(condition.body) + condition.nodes] = number
        self.driven = self._giver >= 0
        self._set_wanted(0.0)
        fixed = self.driven.copy()
        if self.bonds is not None:
            driven = ~np.isnan(self.bonds.first_of(self._wanted))
            fixed[self.bonds.slaves] = True
            fixed[self.bonds.masters] = driven
            self._reaction.array[:] = self.driven
            self.bonds.mark(driven, self._reaction)
            self.driven = self._reaction.array_r > 0.5
        self.fixed = np.flatnonzero(fixed)
        start = self._balance.getOwnershipRange()[0]
        self._fixed_dofs = (self.fixed + start).astype(PETSc.IntType)

    @property
    def _span(self) -> tuple[float, float]:
        """Start and end of the step [s]."""
        return self.time - self.step, self.time

    def _start_of(self, body: ThermalBody) -> int:
        return self._parts[self.bodies.index(body)].start

    def enthalpy(self) -> FloatArray:
        """Return a copy of the enthalpies of the owned nodes of all bodies [J/m³]."""
        return np.concatenate(
            [body.enthalpy.x.array[: body.owned] for body in self.bodies]
        )

    def set_enthalpy(self, enthalpy: FloatArray) -> None:
        """Set the state of all bodies from the enthalpies of the owned nodes [J/m³]."""
        for body, part in zip(self.bodies, self._parts, strict=True):
            body.set_enthalpy(enthalpy[part])

    def mix_bonded(self) -> FloatArray:
        """Bring the nodes of each group to one temperature.

        Returns:
            Heat that passes through each interface on this rank, secondary to primary [J].
        """
        if self.bonds is None:
            return np.zeros(self._interfaces)
        before = self.enthalpy()
        self._enthalpy.array[:] = before
        self.bonds.spread(self.bonds.mix(self._enthalpy), self._enthalpy, self._slope)
        self.set_enthalpy(self._enthalpy.array_r)
        self._balance.array[:] = self.volumes * (self._enthalpy.array_r - before)
        self._wanted.array[:] = np.nan
        return self.bonds.settle(self._balance, self._wanted, self._reaction)

    def coefficients(self, states: Sequence[PairState]) -> list[FloatArray]:
        """Return h of pairs in these states at the present temperatures [W/m²/K]."""
        self._read_temperatures()
        self.exchanges.face(self._temperature, self.time)
        return self.exchanges.coefficients(states)

    def set_dissipation(self, powers: Mapping[str, FloatArray]) -> None:
        """Set what plastic work gives to the owned nodes of bodies [W]; others get nothing."""
        self.dissipation[:] = 0.0
        for body, part in zip(self.bodies, self._parts, strict=True):
            if body.name in powers:
                self.dissipation[part] = powers[body.name]

    def begin(
        self, previous: FloatArray, guess: FloatArray, time: float, step: float
    ) -> FloatArray:
        """Start a step and return the first guess of the unknown.

        Args:
            previous: enthalpies of the nodes at the start of the step [J/m³].
            guess: enthalpies at its end as far as they are known [J/m³].
            time: end of the step [s].
            step: its size [s].
        """
        self.previous, self.time, self.step = previous, time, step
        self._set_wanted(time)
        wanted = self._wanted.array_r
        x = guess.copy()
        for body, part in zip(self.bodies, self._parts, strict=True):
            given = ~np.isnan(wanted[part])
            x[part][given] = body.curve.enthalpy(wanted[part][given])
        if self.bonds is not None:
            self._enthalpy.array[:] = guess
            means = self.bonds.means_at(self.bonds.first_of(self._wanted))
            free = np.isnan(means)
            means[free] = self.bonds.mix(self._enthalpy)[free]
            x[self.bonds.masters] = means
        return x

    def _set_wanted(self, time: float) -> None:
        values = [condition.temperature(time) for condition in self.temperatures]
        self._wanted.array[:] = np.array([*values, np.nan])[self._giver]

    def set_unknown(self, x: PETSc.Vec) -> None:
        """Set the state of all bodies."""
        self._enthalpy.array[:] = x.array_r
        self._slope.array[:] = 1.0
        if self.bonds is not None:
            self.bonds.spread(x.array_r[self.bonds.masters], self._enthalpy, self._slope)
        self.set_enthalpy(self._enthalpy.array_r)
        self._read_temperatures()
        dT = self._temperature_slope.array
        for body, part in zip(self.bodies, self._parts, strict=True):
            dT[part] = body.temperature_slope() * self._slope.array_r[part]

    def _read_temperatures(self) -> None:
        for body, part in zip(self.bodies, self._parts, strict=True):
            self._temperature.array[part] = body.owned_temperature

    @property
    def temperature(self) -> FloatArray:
        """Temperature of the owned nodes of all bodies at the last state [°C]."""
        return np.asarray(self._temperature.array_r)

    def evaluate(self, x: PETSc.Vec) -> None:
        """Evaluate the balance of every node, with what the groups and givers feed left out."""
        self.set_unknown(x)
        storage = self.volumes * (self._enthalpy.array_r - self.previous) / self.step
        balance = self._balance.array
        balance[:] = storage
        through = 0.0
        for body, part in zip(self.bodies, self._parts, strict=True):
            source = body.volumes * body.source(*self._span)
            balance[part] += body.conducted_heat() - source
            through += np.abs(source).sum()
        balance -= self.dissipation
        through += np.abs(self.dissipation).sum()
        for flux in self.fluxes:
            heat, _ = flux.evaluate(*self._span)
            balance[self._start_of(flux.body) + flux.nodes] -= heat
            through += np.abs(heat).sum()
        self.exchanges.face(self._temperature, self.time)
        through += self.exchanges.add_heat(self._balance)
        self._moved = np.abs(storage).sum(), through

    def gather_residual(self, residual: PETSc.Vec) -> None:
        """Sum the balances over the groups; zero where the unknown is fixed."""
        self._gather(self._balance, residual)

    def _gather(self, nodal: PETSc.Vec, gathered: PETSc.Vec) -> None:
        gathered.array[:] = nodal.array_r
        if self.bonds is not None:
            gathered.array[self.bonds.masters] = self.bonds.collect(nodal)
        gathered.array[self.fixed] = 0.0

    def balance(self) -> Balance:
        """Return the sums over all ranks that decide on convergence."""
        storage, through = self._moved
        through += np.abs(self._balance.array_r[self._giver >= 0]).sum()
        rounding = np.abs(self.volumes * self._enthalpy.array_r).sum() / self.step
        rounding += sum(body.rounding().sum() for body in self.bodies)
        local = (np.abs(self.residual.array_r).sum(), storage, through, ROUNDING * rounding)
        residual, storage, through, rounding = sum(np.array(self.layout.comm.allgather(local)))
        return Balance(float(residual), float(max(storage, through)), float(rounding))

    def assemble_jacobian(self, x: PETSc.Vec) -> None:
        """Assemble the derivative of the residual into `jacobian.matrix`."""
        self.set_unknown(x)
        self.exchanges.face(self._temperature, self.time)
        dT = self._temperature_slope.array_r
        diagonal = self.volumes * self._slope.array_r / self.step
        for flux in self.fluxes:
            _, slope = flux.evaluate(*self._span)
            nodes = self._start_of(flux.body) + flux.nodes
            diagonal[nodes] -= slope * dT[nodes]
        self.jacobian.assemble(diagonal, self._temperature_slope)
        typical = self.layout.comm.allreduce(self.volumes.sum()) / self.layout.size_global
        self.jacobian.matrix.zeroRows(self._fixed_dofs, typical / self.step)

    def solid_columns(self, x: PETSc.Vec) -> list[tuple[PETSc.Vec, PETSc.Vec]]:
        """Return what `castx.heat.interfaces` adds to the Jacobian: columns of U and V."""
        feedback = self.exchanges.feedback
        if not feedback.exchanges:
            return []
        self.set_unknown(x)
        self.exchanges.face(self._temperature, self.time)
        columns = []
        for exchange in feedback.exchanges:
            u, v = self.residual.duplicate(), self.residual.duplicate()
            self._reaction.array[:] = 0.0
            exchange.add_heat(exchange.solid_slope(), self._reaction)
            self._gather(self._reaction, u)
            feedback.mean_slope(exchange, self._slope, self._reaction)
            self._gather(self._reaction, v)
            columns.append((u, v))
        return columns

    def flows(self) -> FloatArray:
        """Return the rates of heat on this rank [W].

        Sources, plastic work, fluxes, givers, and each interface by mechanism; bonded nodes touch.
        """
        sources = [body.source(*self._span) * body.volumes.sum() for body in self.bodies]
        plastic = [self.dissipation[part].sum() for part in self._parts]
        fluxes = [flux.evaluate(*self._span)[0].sum() for flux in self.fluxes]
        self._reaction.array[:] = self._balance.array_r
        through = self.exchanges.flows()
        if self.bonds is not None:
            through[:, 0] += self.bonds.settle(self._balance, self._wanted, self._reaction)
        fed = [
            self._reaction.array_r[self._giver == number].sum()
            for number in range(len(self.temperatures))
        ]
        return np.array([*sources, *plastic, *fluxes, *fed, *through.ravel()])

    def destroy(self) -> None:
        """Free the PETSc objects."""
        self.jacobian.destroy()
