"""Discrete balance of heat of all bodies over one implicit Euler step.

The unknown of a node is its enthalpy H_i [J/m³]. Nodes in perfect contact share the mean enthalpy
of their group at the place of its first node; its other places are idle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.heat.body import ThermalBody
from castx.heat.boundaries import SurfaceFlux, SurfaceTemperature
from castx.heat.interface import Exchanges, HeatExchange
from castx.heat.jacobian import HeatJacobian
from castx.heat.perfect_contact import NodeGroups, gather_links
from castx.solvers.layout import Layout

ROUNDING = 8.0 * float(np.finfo(np.float64).eps)
"""Balance below which the residual is round-off, relative to the terms that cancel in it."""


@dataclass(frozen=True)
class BalanceSums:
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


class HeatUnknowns:
    """From the unknowns of a step to the enthalpies and temperatures of all bodies.

    Args:
        layout: numbering of the nodes of all bodies.
        bodies: in the order of the layout.
        exchanges: interfaces; those of perfect contact join nodes.
        temperatures: conditions that give a temperature; where two meet, the first applies.

    Attributes:
        temperature: of the nodes at the last state [°C].
        slope: derivative of the enthalpy of each node over its unknown.
        temperature_slope: derivative of the temperature of each node over its unknown [K m³/J].
        volumes: that the owned nodes stand for [m³].
        groups: nodes that share an unknown; None: there are none.
        conditioned: owned nodes with a condition that gives their temperature.
        prescribed: owned nodes whose temperature is prescribed, by their group too.
        fixed: owned unknowns that solve no balance.
    """

    def __init__(
        self,
        layout: Layout,
        bodies: Sequence[ThermalBody],
        exchanges: Sequence[HeatExchange],
        temperatures: Sequence[SurfaceTemperature],
    ) -> None:
        self.layout, self.bodies = layout, tuple(bodies)
        self.parts = [layout.local_slice(k) for k in range(len(bodies))]
        self.volumes = np.concatenate([body.volumes for body in self.bodies])
        create = layout.create_vector
        self.enthalpy, self.slope = create(), create()
        self.temperature, self.temperature_slope = create(), create()
        self._temperatures, self._interfaces = tuple(temperatures), len(exchanges)
        self.groups = self._join_nodes(exchanges)
        self._find_prescribed()

    def _join_nodes(self, exchanges: Sequence[HeatExchange]) -> NodeGroups | None:
        names = [body.name for body in self.bodies]
        links = gather_links(self.layout.comm, self.layout, names, exchanges)
        if not len(links.dofs):
            return None
        volumes = self._vector(self.volumes)
        groups = NodeGroups(links, self._interfaces, self.bodies, volumes)
        volumes.destroy()
        return groups

    def _find_prescribed(self) -> None:
        """Find nodes of prescribed temperature and unknowns that solve no balance."""
        self._condition_of = np.full(self.layout.size_local, -1)
        for number, condition in reversed(list(enumerate(self._temperatures))):
            self._condition_of[self.start_of(condition.body) + condition.nodes] = number
        self.conditioned: BoolArray = self._condition_of >= 0
        self.prescribed = self.conditioned
        fixed = self.prescribed.copy()
        if self.groups is not None:
            given, marks = self._vector(self._given_at(0.0)), self._vector(self.prescribed)
            self._fed_members = self.groups.first_places(given)
            prescribed = self._fed_members >= 0
            fixed[self.groups.idle] = True
            fixed[self.groups.firsts] = prescribed
            self.groups.spread(prescribed.astype(np.float64), marks)
            self.prescribed = marks.array_r > 0.5
            given.destroy()
            marks.destroy()
        self.fixed = np.flatnonzero(fixed)

    def _vector(self, values: FloatArray | BoolArray) -> PETSc.Vec:
        """Return a vector of values at the owned nodes; the caller destroys it."""
        vector = self.layout.create_vector()
        vector.array[:] = values
        return vector

    def start_of(self, body: ThermalBody) -> int:
        """Return the place of the first node of a body among the owned nodes."""
        return int(self.parts[self.bodies.index(body)].start)

    def _given_at(self, time: float) -> FloatArray:
        """Return prescribed temperatures of the owned nodes at a time [s], NaN at other nodes."""
        values = np.full(self.layout.size_local, np.nan)
        for condition in reversed(self._temperatures):
            values[self.start_of(condition.body) + condition.nodes] = condition.temperature(time)
        return values

    def enthalpies(self) -> FloatArray:
        """Return a copy of the enthalpies of the owned nodes of all bodies [J/m³]."""
        return np.concatenate([body.enthalpy.x.array[: body.owned] for body in self.bodies])

    def set_enthalpies(self, enthalpies: FloatArray) -> None:
        """Set the state of all bodies from the enthalpies of the owned nodes [J/m³]."""
        for body, part in zip(self.bodies, self.parts, strict=True):
            body.set_enthalpy(enthalpies[part])

    def first_guess(self, guess: FloatArray, time: float) -> FloatArray:
        """Return the first guess of the unknowns at the end of a step.

        Args:
            guess: enthalpies of the nodes as far as they are known [J/m³].
            time: end of the step [s]; prescribed temperatures are those of this time.
        """
        x, given = guess.copy(), self._given_at(time)
        for body, part in zip(self.bodies, self.parts, strict=True):
            known = ~np.isnan(given[part])
            x[part][known] = body.curve.enthalpy(given[part][known])
        if self.groups is not None:
            self.enthalpy.array[:] = guess
            there = self._vector(given)
            means = self.groups.means_at(self.groups.first_of(there))
            there.destroy()
            free = np.isnan(means)
            means[free] = self.groups.means(self.enthalpy)[free]
            x[self.groups.firsts] = means
        return x

    def set(self, x: PETSc.Vec) -> None:
        """Set the state of all bodies from the unknowns."""
        self.enthalpy.array[:] = x.array_r
        self.slope.array[:] = 1.0
        if self.groups is not None:
            self.groups.set_members(x.array_r[self.groups.firsts], self.enthalpy, self.slope)
        self.set_enthalpies(self.enthalpy.array_r)
        self.read_temperatures()
        dT = self.temperature_slope.array
        for body, part in zip(self.bodies, self.parts, strict=True):
            dT[part] = body.temperature_slope() * self.slope.array_r[part]

    def read_temperatures(self) -> None:
        """Copy the temperatures of the bodies into the vector of all nodes."""
        for body, part in zip(self.bodies, self.parts, strict=True):
            self.temperature.array[part] = body.owned_temperature

    def equalise(self) -> FloatArray:
        """Bring the nodes of each group to one temperature.

        Returns:
            Heat that passes through each interface on this rank, secondary to primary [J].
        """
        if self.groups is None:
            return np.zeros(self._interfaces)
        before = self.enthalpies()
        self.enthalpy.array[:] = before
        self.groups.set_members(self.groups.means(self.enthalpy), self.enthalpy, self.slope)
        self.set_enthalpies(self.enthalpy.array_r)
        taken = self._vector(self.volumes * (self.enthalpy.array_r - before))
        through, _ = self.groups.heat_through(taken, np.full(len(self.groups.firsts), -1))
        taken.destroy()
        return through

    def gather(self, nodal: PETSc.Vec, gathered: PETSc.Vec) -> None:
        """Sum a nodal balance over the groups; zero where the unknown is fixed."""
        gathered.array[:] = nodal.array_r
        if self.groups is not None:
            gathered.array[self.groups.firsts] = self.groups.sums(nodal)
        gathered.array[self.fixed] = 0.0

    def reactions(self, balance: PETSc.Vec) -> tuple[FloatArray, FloatArray]:
        """Return the heat of prescribed temperatures and of perfect contact [W], on this rank.

        Args:
            balance: heat that leaves each node.

        Returns:
            What each prescribed temperature feeds, and what passes through perfect contact at each
            interface.
        """
        reaction = balance.copy()
        through: FloatArray = np.zeros(self._interfaces)
        if self.groups is not None:
            through, feeding = self.groups.heat_through(balance, self._fed_members)
            self.groups.set_at_members(feeding, reaction)
        fed = [
            reaction.array_r[self._condition_of == number].sum()
            for number in range(len(self._temperatures))
        ]
        reaction.destroy()
        return np.array(fed), through


class HeatBalance:
    """Residual [W] and Jacobian of all nodal balances in the nodal enthalpies.

        V_i (H_i − H_i^n)/Δt + Σ_j L_ij θ_j − sources − surfaces ± exchange = 0

    with the volume V_i of node i, L_ij = ∫ ∇φ_i·∇φ_j and the conduction potential θ = ∫ k dT.
    Source: M. Chiumenti, Thermo-mechanical contact in casting analysis, section 2.3, with the
    storage lumped at the nodes.

    Sources and surroundings enter by their means over the step, temperatures by those at its end.

    Args:
        unknowns: from the unknowns to the state of the bodies.
        exchanges: interfaces.
        fluxes: conditions that give a flux.
    """

    def __init__(
        self,
        unknowns: HeatUnknowns,
        exchanges: Sequence[HeatExchange],
        fluxes: Sequence[SurfaceFlux],
    ) -> None:
        self.unknowns, self.fluxes = unknowns, tuple(fluxes)
        layout, bodies = unknowns.layout, unknowns.bodies
        self.layout, self.bodies, self._parts = layout, bodies, unknowns.parts
        self.time, self.step = 0.0, 1.0
        self.residual, self._balance = layout.create_vector(), layout.create_vector()
        self._column = layout.create_vector()
        self._present: FloatArray | None = None
        self._storage = self._through = 0.0  # amounts on this rank at the last evaluation [W]
        self.previous = unknowns.enthalpies()
        self.dissipation: FloatArray = np.zeros(layout.size_local)
        self.exchanges = Exchanges(layout, self._balance, bodies, exchanges)
        self.jacobian = HeatJacobian(layout, bodies, self.exchanges.under_law, unknowns.groups)
        start = self._balance.getOwnershipRange()[0]
        self._fixed_dofs = (unknowns.fixed + start).astype(PETSc.IntType)

    @property
    def _span(self) -> tuple[float, float]:
        """Start and end of the step [s]."""
        return self.time - self.step, self.time

    def set_dissipation(self, powers: Mapping[str, FloatArray]) -> None:
        """Set the heat of plastic work at the owned nodes of bodies [W]; zero in other bodies."""
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

        Raises:
            CaseError: a flux or a temperature that varies with place is none; on all ranks.
        """
        self.previous, self.time, self.step = previous, time, step
        self._present = None
        for flux in self.fluxes:
            flux.begin(*self._span)
        return self.unknowns.first_guess(guess, time)

    def _set(self, x: PETSc.Vec) -> None:
        """Set the state of bodies and interfaces from the unknowns."""
        self.unknowns.set(x)
        self.exchanges.update_faces(self.unknowns.temperature, self.time)
        self._present = x.array_r.copy()

    def _return_to(self, x: PETSc.Vec) -> None:
        """Set the state of the unknowns x unless it is the present one; collective.

        Newton's method asks for the Jacobian where it has just asked for the residual.
        """
        there = self._present is not None and np.array_equal(self._present, x.array_r)
        if not self.layout.comm.allreduce(there, op=MPI.LAND):
            self._set(x)

    def fill_residual(self, x: PETSc.Vec, residual: PETSc.Vec) -> None:
        """Fill the residual: balances summed over the groups; zero where the unknown is fixed."""
        self.evaluate(x)
        self.unknowns.gather(self._balance, residual)

    def evaluate(self, x: PETSc.Vec) -> None:
        """Evaluate the balance of every node without heat of groups and prescribed temperatures."""
        unknowns = self.unknowns
        self._set(x)
        storage = unknowns.volumes * (unknowns.enthalpy.array_r - self.previous) / self.step
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
            balance[unknowns.start_of(flux.body) + flux.nodes] -= heat
            through += np.abs(heat).sum()
        through += self.exchanges.add_heat(self._balance)
        self._storage, self._through = float(np.abs(storage).sum()), float(through)

    @property
    def leaving(self) -> FloatArray:
        """Heat that leaves the owned nodes at the last evaluation [W], shape (owned nodes,)."""
        return np.array(self._balance.array_r)

    def sums(self) -> BalanceSums:
        """Return the sums over all ranks that decide on convergence, at the last residual."""
        storage, through = self._storage, self._through
        through += np.abs(self._balance.array_r[self.unknowns.conditioned]).sum()
        contents = self.unknowns.volumes * self.unknowns.enthalpy.array_r
        rounding = np.abs(contents).sum() / self.step
        rounding += sum(body.rounding().sum() for body in self.bodies)
        local = (np.abs(self.residual.array_r).sum(), storage, through, ROUNDING * rounding)
        residual, storage, through, rounding = sum(np.array(self.layout.comm.allgather(local)))
        return BalanceSums(float(residual), float(max(storage, through)), float(rounding))

    def assemble_jacobian(self, x: PETSc.Vec) -> None:
        """Assemble the derivative of the residual into `jacobian.matrix`."""
        unknowns = self.unknowns
        self._return_to(x)
        dT = unknowns.temperature_slope.array_r
        diagonal = unknowns.volumes * unknowns.slope.array_r / self.step
        for flux in self.fluxes:
            _, slope = flux.evaluate(*self._span)
            nodes = unknowns.start_of(flux.body) + flux.nodes
            diagonal[nodes] -= slope * dT[nodes]
        self.jacobian.assemble(diagonal, unknowns.temperature_slope)
        typical = self.layout.comm.allreduce(unknowns.volumes.sum()) / self.layout.size_global
        self.jacobian.matrix.zeroRows(self._fixed_dofs, typical / self.step)

    def solid_columns(self, x: PETSc.Vec) -> list[tuple[PETSc.Vec, PETSc.Vec]]:
        """Return the columns of U and V that solid fractions add to the Jacobian, J + U Vᵀ."""
        unknowns = self.unknowns
        if not self.exchanges.fed_back:
            return []
        self._return_to(x)
        columns = []
        for exchange in self.exchanges.fed_back:
            u, v = self.residual.duplicate(), self.residual.duplicate()
            self._column.array[:] = 0.0
            exchange.add_heat(exchange.solid_slope(), self._column)
            unknowns.gather(self._column, u)
            slope = unknowns.slope
            self.exchanges.feedback.mean_slope(exchange.secondary, slope, self._column)
            unknowns.gather(self._column, v)
            columns.append((u, v))
        return columns

    def flows(self) -> FloatArray:
        """Return the rates of heat on this rank [W] in the order of `accounts_of`.

        Sources, plastic work, fluxes, prescribed temperatures, and each interface by mechanism;
        nodes in perfect contact touch.
        """
        sources = [body.source(*self._span) * body.volumes.sum() for body in self.bodies]
        plastic = [self.dissipation[part].sum() for part in self._parts]
        fluxes = [flux.evaluate(*self._span)[0].sum() for flux in self.fluxes]
        through = self.exchanges.flows()
        fed, touching = self.unknowns.reactions(self._balance)
        if self.unknowns.groups is not None:
            through[:, 0] += touching
        return np.array([*sources, *plastic, *fluxes, *fed, *through.ravel()])

    def destroy(self) -> None:
        """Free the PETSc objects."""
        self.jacobian.destroy()
