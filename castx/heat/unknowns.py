"""Unknowns of a step of the heat problem: enthalpies of nodes, and of groups in perfect contact."""

from __future__ import annotations

from collections.abc import Sequence

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.heat.body import ThermalBody
from castx.heat.boundaries import SurfaceTemperature
from castx.heat.interface import HeatExchange
from castx.heat.perfect_contact import NodeGroups, gather_links
from castx.solvers.layout import Layout


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

    def stored(self, enthalpies: FloatArray) -> FloatArray:
        """Return the heat that nodes of enthalpies [J/m³] store [J], shape (owned,); collective."""
        parts = zip(self.bodies, self.parts, strict=True)
        inside = [body.latent_heat_inside(enthalpies[part]) for body, part in parts]
        return np.asarray(self.volumes * enthalpies + np.concatenate(inside))

    def stored_at_present(self) -> FloatArray:
        """Return the heat that nodes store in a state just set [J], shape (owned,); collective."""
        inside = [body.present_latent_heat_inside() for body in self.bodies]
        return np.asarray(self.volumes * self.enthalpy.array_r + np.concatenate(inside))

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
        taken = self._vector(self.stored(self.enthalpies()) - self.stored(before))
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
