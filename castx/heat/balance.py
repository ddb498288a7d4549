"""Discrete balance of heat of all bodies over one implicit Euler step.

The unknown of a node is its enthalpy H_i [J/m³]. Nodes in perfect contact share the mean enthalpy
of their group at the place of its first node; its other places are idle (`unknowns`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.heat.boundaries import SurfaceFlux
from castx.heat.interface import Exchanges, HeatExchange
from castx.heat.jacobian import HeatJacobian
from castx.heat.unknowns import HeatUnknowns

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
        self._stored_before = unknowns.stored(self.previous)
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
        self._stored_before = self.unknowns.stored(previous)
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
        storage = (unknowns.stored_at_present() - self._stored_before) / self.step
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
        self._return_to(x)
        self.assemble_with(self.unknowns.temperature_slope, self.step)

    def assemble_with(self, temperature_slope: PETSc.Vec, step: float) -> None:
        """Assemble the Jacobian of the state just set, with other slopes over another step.

        Args:
            temperature_slope: derivative of the temperature of each node over its unknown
                [K m³/J].
            step: over which heat is stored [s].
        """
        unknowns, dT = self.unknowns, temperature_slope.array_r
        diagonal = unknowns.volumes * unknowns.slope.array_r / step
        for flux in self.fluxes:
            _, slope = flux.evaluate(*self._span)
            nodes = unknowns.start_of(flux.body) + flux.nodes
            diagonal[nodes] -= slope * dT[nodes]
        inside = [
            body.latent_heat_slope(unknowns.slope.array_r[part])
            for body, part in zip(self.bodies, self._parts, strict=True)
        ]
        self.jacobian.assemble(diagonal, temperature_slope, inside, step)
        typical = self.layout.comm.allreduce(unknowns.volumes.sum()) / self.layout.size_global
        self.jacobian.matrix.zeroRows(self._fixed_dofs, typical / step)

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
