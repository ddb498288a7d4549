"""Perfect thermal contact: facing nodes with one temperature.

The nodes of a group share one unknown, their mean enthalpy H̄(T) = Σ V_m H_m(T) / Σ V_m over the
volumes they stand for. It is inverted exactly, node by node, also while a member melts at constant
temperature: between the knots of the members' curves everything is linear.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components

from castx.arrays import FloatArray, IntArray, LongArray
from castx.heat.body import ThermalBody
from castx.heat.interface import HeatExchange
from castx.materials.enthalpy import EnthalpyCurve
from castx.solvers.layout import Layout
from castx.solvers.remote_entries import RemoteEntries


@dataclass(frozen=True)
class Links:
    """Pairs of all perfect interfaces, the same on all ranks.

    Attributes:
        dofs: of secondary and primary node, shape (links, 2).
        bodies: their bodies' numbers, shape (links, 2).
        interfaces: number of the interface of each link, shape (links,).
    """

    dofs: LongArray
    bodies: LongArray
    interfaces: LongArray


def gather_links(
    comm: MPI.Intracomm, layout: Layout, names: Sequence[str], exchanges: Sequence[HeatExchange]
) -> Links:
    """Return the pairs of all perfect interfaces of all ranks.

    Args:
        comm: all ranks.
        layout: numbering of the nodes of all bodies.
        names: of the bodies in the order of the layout.
        exchanges: all interfaces; those that are not perfect are passed over.
    """
    rows = [np.empty((0, 5), dtype=np.int64)]
    for interface, exchange in enumerate(exchanges):
        if exchange.kind != "perfect":
            continue
        pairs = exchange.pairs
        secondary, primary = names.index(pairs.secondary), names.index(pairs.primary)
        row = np.empty((len(pairs.areas), 5), dtype=np.int64)
        row[:, 0] = layout.dofs(secondary, pairs.secondary_nodes, 0)
        row[:, 1] = layout.dofs(primary, pairs.primary_nodes, 0)
        row[:, 2:] = secondary, primary, interface
        # Pairs of several patches at one node are one link.
        first = np.sort(np.unique(row[:, 0], return_index=True)[1])
        rows.append(row[first, :].reshape(-1, 5))
    table = np.concatenate(comm.allgather(np.concatenate(rows)))
    return Links(table[:, :2], table[:, 2:4], table[:, 4])


class JoinedNodes:
    """Groups of nodes with the same bodies, and their common temperature.

    Args:
        curves: of the members of a group.
        volumes: they stand for, shape (groups, members) [m³].
    """

    def __init__(self, curves: Sequence[EnthalpyCurve], volumes: FloatArray) -> None:
        self.volumes = volumes
        self.curves = curves
        self._knots = _common_knots(curves)
        self._means = volumes @ self._knots / volumes.sum(axis=1)[:, None]

    def split(self, mean: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the enthalpies of the members at their common temperature.

        Args:
            mean: mean enthalpies, shape (groups,) [J/m³].

        Returns:
            Enthalpies and their derivatives over the mean, shape (groups, members) each.
        """
        groups = np.arange(len(mean))
        start = (self._means <= mean[:, None]).sum(axis=1) - 1
        start = np.clip(start, 0, self._means.shape[1] - 2)
        rise = self._means[groups, start + 1] - self._means[groups, start]
        slopes = (self._knots[:, start + 1] - self._knots[:, start]).T / rise[:, None]
        distance = mean - self._means[groups, start]
        return self._knots[:, start].T + slopes * distance[:, None], slopes

    def mean(self, temperature: FloatArray) -> FloatArray:
        """Return the mean enthalpies at common temperatures, shape (groups,)."""
        enthalpies = np.column_stack([curve.enthalpy(temperature) for curve in self.curves])
        return np.asarray((self.volumes * enthalpies).sum(axis=1) / self.volumes.sum(axis=1))


def _common_knots(curves: Sequence[EnthalpyCurve]) -> FloatArray:
    """Return the enthalpies of all curves where one of them bends, shape (curves, knots).

    The temperature of a plateau counts twice, with its lower and its upper end.
    """
    temperatures = np.unique(np.concatenate([curve.temperatures for curve in curves]))
    upper = np.array([curve.enthalpy(temperatures) for curve in curves])
    lower = upper.copy()
    for k, curve in enumerate(curves):
        first = np.searchsorted(curve.temperatures, temperatures, side="left")
        known = first < curve.temperatures.size
        known[known] = curve.temperatures[first[known]] == temperatures[known]
        lower[k, known] = curve.enthalpies[first[known]]
    plateau = np.array(
        [np.isin(temperatures, _plateaus(curve)) for curve in curves]
    )
    lower = np.where(plateau, lower, upper)
    doubled = np.stack((lower, upper), axis=2).reshape(len(curves), -1)
    keep = np.stack((plateau.any(axis=0), np.ones(len(temperatures), dtype=bool)), axis=1).ravel()
    return doubled[:, keep]


def _plateaus(curve: EnthalpyCurve) -> FloatArray:
    """Return the temperatures at which a material melts isothermally."""
    T = curve.temperatures
    return np.asarray(T[:-1][T[1:] == T[:-1]])


class NodeGroups:
    """All groups of nodes in perfect contact; a rank works on those whose first node it owns.

    Args:
        links: pairs of the perfect interfaces.
        interfaces: number of interfaces, perfect or not.
        bodies: in the order of the layout.
        volumes: the nodes stand for, in the layout.

    Attributes:
        firsts: places of the first nodes of the groups of this rank, whose unknowns stand for them.
        idle: places of the members whose own unknown is not used.
        volumes: that the members of the groups of this rank stand for [m³].
    """

    def __init__(
        self, links: Links, interfaces: int, bodies: Sequence[ThermalBody], volumes: PETSc.Vec
    ) -> None:
        self._members, inverse = np.unique(links.dofs, return_inverse=True)
        inverse = inverse.reshape(links.dofs.shape)
        count = len(self._members)
        graph = coo_array((np.ones(len(inverse)), inverse.T), shape=(count, count)).tocsr()
        _, labels = connected_components(graph, directed=False)
        _, first = np.unique(labels, return_index=True)
        self._first_members = self._members[first][labels]
        member_bodies = np.empty(count, dtype=np.int64)
        member_bodies[inverse] = links.bodies

        start, end = volumes.getOwnershipRange()
        chosen = np.flatnonzero((self._first_members >= start) & (self._first_members < end))
        chosen = chosen[np.lexsort((self._members[chosen], self._first_members[chosen]))]
        self._remote = RemoteEntries(volumes, self._members[chosen].astype(PETSc.IntType))
        _, self._starts, self._groups = np.unique(
            self._first_members[chosen], return_index=True, return_inverse=True
        )
        self.firsts = (self._first_members[chosen][self._starts] - start).astype(np.int32)
        mine = (self._members >= start) & (self._members < end)
        self.idle = (self._members[mine & (self._members != self._first_members)] - start).astype(
            np.int32
        )
        self._sort_groups(bodies, member_bodies[chosen], self._remote.get(volumes))
        weights = _flow_weights(links, inverse, labels, interfaces)
        self._flow_weights = weights[:, chosen]

    def _sort_groups(
        self, bodies: Sequence[ThermalBody], member_bodies: LongArray, volumes: FloatArray
    ) -> None:
        """Sort the groups by the bodies they join."""
        self.volumes = volumes
        sizes = np.diff(np.append(self._starts, len(self._groups)))
        kinds: dict[tuple[int, ...], list[int]] = {}
        for group, (begin, size) in enumerate(zip(self._starts, sizes, strict=True)):
            kinds.setdefault(tuple(member_bodies[begin : begin + size]), []).append(group)
        self._kinds = []
        for kind, groups in kinds.items():
            places = self._starts[groups][:, None] + np.arange(len(kind))
            nodes = JoinedNodes([bodies[k].curve for k in kind], volumes[places])
            self._kinds.append((np.array(groups), places, nodes))

    def unknowns(self, dofs: IntArray) -> IntArray:
        """Return the global number of the unknown that stands for each node."""
        place = np.searchsorted(self._members, dofs)
        place = np.minimum(place, len(self._members) - 1)
        joined = self._members[place] == dofs
        return np.where(joined, self._first_members[place], dofs).astype(PETSc.IntType)

    def means(self, enthalpy: PETSc.Vec) -> FloatArray:
        """Return the mean enthalpies of the groups of this rank [J/m³]."""
        return self._sums(self.volumes * self._remote.get(enthalpy)) / self._sums(self.volumes)

    def set_members(self, mean: FloatArray, enthalpy: PETSc.Vec, slope: PETSc.Vec) -> None:
        """Set the enthalpies of all members, and their derivatives over the mean."""
        enthalpies = np.empty(len(self._groups))
        slopes = np.empty(len(self._groups))
        for groups, places, nodes in self._kinds:
            enthalpies[places], slopes[places] = nodes.split(mean[groups])
        self._remote.put(enthalpies, enthalpy)
        self._remote.put(slopes, slope)

    def sums(self, balance: PETSc.Vec) -> FloatArray:
        """Return the sums of a balance over the members of the groups of this rank."""
        return self._sums(self._remote.get(balance))

    def means_at(self, temperature: FloatArray) -> FloatArray:
        """Return the mean enthalpies of the groups at temperatures, NaN where that is NaN."""
        means = np.empty_like(temperature)
        for groups, _, nodes in self._kinds:
            means[groups] = nodes.mean(temperature[groups])
        return np.where(np.isnan(temperature), np.nan, means)

    def first_of(self, given: PETSc.Vec) -> FloatArray:
        """Return for each group the first entry of its members that is not NaN, else NaN."""
        return self._first(self._remote.get(given))[0]

    def first_places(self, given: PETSc.Vec) -> LongArray:
        """Return the place of that entry among the members of this rank's groups, -1: none."""
        return self._first(self._remote.get(given))[1]

    def _first(self, values: FloatArray) -> tuple[FloatArray, LongArray]:
        """Return the first number of each group and its place among the members, -1 if none."""
        places = np.where(np.isnan(values), len(values), np.arange(len(values)))
        places = np.minimum.reduceat(places, self._starts) if len(values) else places
        found = places < len(values)
        numbers = np.full(len(places), np.nan)
        numbers[found] = values[places[found]]
        return numbers, np.where(found, places, -1)

    def spread(self, values: FloatArray, vector: PETSc.Vec) -> None:
        """Set all members of each group of this rank to the value of the group; collective."""
        self._remote.put(values[self._groups], vector)

    def set_at_members(self, values: FloatArray, vector: PETSc.Vec) -> None:
        """Set the entries of the members of this rank's groups; collective."""
        self._remote.put(values, vector)

    def heat_through(self, balance: PETSc.Vec, fed: LongArray) -> tuple[FloatArray, FloatArray]:
        """Return the heat through each interface, and that which feeds groups, on this rank [W].

        Args:
            balance: heat that leaves each node, without that through perfect contact.
            fed: place of the member of each group that a prescribed temperature feeds, -1: none.

        Returns:
            Heat from secondary to primary, shape (interfaces,); heat that feeds each member of this
            rank's groups, zero but at those places.
        """
        left = self._remote.get(balance)
        fixed = np.flatnonzero(fed >= 0)
        feeding = np.zeros_like(left)
        feeding[fed[fixed]] = self._sums(left)[fixed]
        return np.asarray(self._flow_weights @ (left - feeding)), feeding

    def _sums(self, values: FloatArray) -> FloatArray:
        """Return the sums over the members of each group."""
        sums = np.zeros(len(self._starts))
        np.add.at(sums, self._groups, values)
        return sums


def _flow_weights(
    links: Links, inverse: LongArray, labels: LongArray, interfaces: int
) -> FloatArray:
    """Return the weights of the heat that members take up in the heat through the interfaces.

    In each group the links that form a tree carry the heat: a link passes from its secondary to its
    primary side what the members behind it take up.

    Returns:
        Weights, shape (interfaces, members).
    """
    count = len(labels)
    weights = np.zeros((interfaces, count))
    sizes = np.bincount(labels, minlength=1)
    simple = sizes[labels[inverse[:, 0]]] == 2
    weights[links.interfaces[simple], inverse[simple, 1]] = 1.0
    for group in np.flatnonzero(sizes > 2):
        inside = np.flatnonzero(labels[inverse[:, 0]] == group)
        _add_tree_weights(weights, inverse[inside], links.interfaces[inside])
    return weights


def _add_tree_weights(weights: FloatArray, ends: LongArray, interfaces: LongArray) -> None:
    """Add the weights of one group with more than two members."""
    members, local = np.unique(ends, return_inverse=True)
    local = local.reshape(ends.shape)
    shape = (len(members), len(members))
    graph = coo_array((np.ones(len(local)), local.T), shape=shape).tocsr()
    order, before = breadth_first_order(graph, 0, directed=False)
    behind = np.eye(len(members))
    for node in order[:0:-1]:
        behind[before[node]] += behind[node]
        between = (np.sort(local, axis=1) == sorted((node, before[node]))).all(axis=1)
        link = np.flatnonzero(between)[0]
        sign = 1.0 if local[link, 1] == node else -1.0
        weights[interfaces[link], members] += sign * behind[node]
