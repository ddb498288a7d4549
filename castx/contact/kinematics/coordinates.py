"""Coordinates in which every constraint on a node fixes one number.

At each node the displacement is read in rows of its own: directions with a prescribed value, the
motion relative to a facing node along its normal (condensed contact), and what completes them to a
basis. The coordinates v and the displacements u of all bodies are tied by the square, invertible
v = R u and u = P v, which do not depend on which pairs are closed:

    v_k = n_k · (u_secondary - u_primary)     contact: the change of the gap
    v_k = e · u                               prescribed direction
    v_k = e · (u - u_first)                   nodes of a surface that move equally: always zero
    v_k = w - w_first                         the axial strain of a body: always zero

A closed pair or a prescribed displacement is then a Dirichlet condition on one entry of v, and the
contact force is the residual of that row of Pᵀ r(P v).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.contact.kinematics.basis import BasisMatrices
from castx.contact.kinematics.node_rows import NodeRows
from castx.contact.kinematics.rows import InterfaceRows, Treatment
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.mechanics.fixed_directions import PARALLEL, ZERO, FixedDirections
from castx.solvers.layout import Layout
from castx.stateful import Numbering, numbered_at_nodes
from castx.tables import Table

GRAZING = 0.05
"""Sine of the smallest angle at which a node with fixed directions can still leave its partner."""


@dataclass(frozen=True)
class Prescribed:
    """Owned entries of v that a condition prescribes, with their displacement over time [m]."""

    local: IntArray
    value: Table


@dataclass(frozen=True)
class PairCoordinates:
    """Where the rows of the pairs of one interface live.

    Attributes:
        pairs: the node pairs.
        index: number of the pair of each row, shape (rows,).
        normals: normals that respect the symmetry planes, shape (rows, dimension).
        areas: contact areas [m²] that turn forces into pressures, shape (rows,).
        local: local number in v of each row's gap, shape (rows,); -1 where no normal motion is
            free.
        treatment: what the coordinates make of the rows.
        tangents: orthonormal directions along the surface that are free, zero where there are
            fewer, shape (rows, dimension - 1, dimension); of tied pairs none.
        tangent_local: local number in v of the motion along each, -1 where it is no coordinate,
            shape (rows, dimension - 1).
    """

    pairs: NodePairs
    index: IntArray
    normals: FloatArray
    areas: FloatArray
    local: IntArray
    treatment: Treatment
    tangents: FloatArray
    tangent_local: IntArray

    @property
    def numbering(self) -> Numbering:
        """The rows by the numbers of their secondary nodes and their turn among those of a node."""
        nodes = self.pairs.original_nodes[self.index]
        bodies = (self.pairs.secondary, self.pairs.primary)
        return numbered_at_nodes(f"rows of {self.pairs.name}", nodes, bodies)

    @property
    def free(self) -> BoolArray:
        """Which rows carry a constraint."""
        return self.local >= 0


class Coordinates:
    """The change of coordinates of all bodies and the entries that conditions fix.

    Args:
        layout: numbering of the displacements (and pressures) of all bodies.
        body_names: names of the bodies in the order of the layout.
        dimension: number of displacement components.
        fixed: fixed directions of each body.
        interfaces: rows of the interfaces with contact; a primary body without unknowns is rigid.
        uniform: of each body, the component of its unknowns that is the same at all nodes, or None.

    Raises:
        CaseError: a uniform surface or a pair whose motion a condition prescribes.
    """

    def __init__(
        self,
        layout: Layout,
        body_names: Sequence[str],
        dimension: int,
        fixed: Sequence[Sequence[FixedDirections]],
        interfaces: Sequence[InterfaceRows],
        uniform: Sequence[int | None] = (),
    ) -> None:
        self.layout = layout
        self._uniform = [(b, k) for b, k in enumerate(uniform) if k is not None]
        self._names = list(body_names)
        self.dimension = dimension
        self._rows = [
            NodeRows.none(self.owned_nodes(b), dimension) for b in range(len(body_names))
        ]
        self.prescribed: list[Prescribed] = []
        self._ties: list[tuple[int, IntArray, IntArray]] = []
        for b, conditions in enumerate(fixed):
            for condition in conditions:
                self._add_condition(b, condition)
        held = [rows.copy() for rows in self._rows]
        self.interfaces = self._add_interfaces(interfaces, fixed)
        for interface in self.interfaces:
            if interface.pairs.primary in self._names:
                self._refuse_one_sided(interface, held)
        self._fill_matrices()

    def _fill_matrices(self) -> None:
        basis = BasisMatrices(self.layout, self.dimension, self._rows)
        for b, nodes, slots in self._ties:
            local = basis.tie(b, nodes, slots)
            self.prescribed.append(Prescribed(local, ZERO))
        for b, k in self._uniform:
            self.prescribed.append(Prescribed(basis.tie_component(b, k), ZERO))
        for interface in self.interfaces:
            if interface.treatment is not Treatment.READ and interface.pairs.primary in self._names:
                self._make_relative(basis, interface, interface.local, interface.normals)
                for k in range(interface.tangents.shape[1]):
                    along = interface.tangent_local[:, k]
                    self._make_relative(basis, interface, along, interface.tangents[:, k])
        self.to_coordinates, self.to_displacements = basis.finish()

    def _make_relative(
        self,
        basis: BasisMatrices,
        interface: PairCoordinates,
        local: IntArray,
        directions: FloatArray,
    ) -> None:
        pairs, free = interface.pairs, local >= 0
        nodes, weights = pairs.partners
        chosen = interface.index[free]
        basis.make_relative(
            self._names.index(pairs.secondary),
            pairs.secondary_local[chosen],
            local[free],
            directions[free],
            self._names.index(pairs.primary),
            (nodes[chosen], weights[chosen]),
        )

    def owned_nodes(self, b: int) -> int:
        """Return the number of nodes of a body that this rank owns."""
        part = self.layout.local_slice(b)
        return (part.stop - part.start) // self.layout.block_sizes[b]

    def facing(self) -> BoolArray:
        """Return which owned unknowns belong to nodes of pairs; collective."""
        marker = self.layout.create_vector()
        for interface in self.interfaces:
            pairs = interface.pairs
            facing = (pairs.primary, pairs.partners[0].ravel())
            for name, nodes in ((pairs.secondary, pairs.secondary_nodes), facing):
                b = self._names.index(name) if name in self._names else -1
                for k in range(self.layout.block_sizes[b] if b >= 0 else 0):
                    numbers = self.layout.dofs(b, nodes, k)
                    ones = np.ones(len(numbers))
                    marker.setValues(numbers, ones, PETSc.InsertMode.ADD_VALUES)
        marker.assemble()
        found = marker.array_r > 0
        marker.destroy()
        return np.asarray(found)

    def _local(self, b: int, nodes: IntArray, slots: IntArray) -> IntArray:
        start, size = self.layout.local_slice(b).start, self.layout.block_sizes[b]
        return np.where(slots < 0, -1, start + nodes * size + slots).astype(np.int32)

    def _add_condition(self, b: int, condition: FixedDirections) -> None:
        slots = self._rows[b].try_add(condition.nodes, condition.directions, PARALLEL)
        kept = slots >= 0
        local = self._local(b, condition.nodes[kept], slots[kept])
        if condition.value is None:
            self._refuse_held(b, condition, ~kept)
            self._ties.append((b, condition.nodes, slots))
        else:
            self.prescribed.append(Prescribed(local, condition.value))

    def _refuse_held(
        self, b: int, condition: FixedDirections, held: BoolArray
    ) -> None:
        if self.layout.comm.allreduce(bool(held.any()), op=MPI.LOR):
            raise CaseError(
                f"{condition.name} is uniform, but another condition on {self._names[b]!r} "
                "prescribes this direction at some of its nodes; leave one of them out"
            )

    def _add_interfaces(
        self, interfaces: Sequence[InterfaceRows], fixed: Sequence[Sequence[FixedDirections]]
    ) -> list[PairCoordinates]:
        """Add the rows of all interfaces, ties first: what is tied has no gap."""
        placed = {}
        tied = [i for i in interfaces if i.treatment is Treatment.TIED]
        for interface in tied:
            placed[id(interface)] = self._tie_pairs(interface)
        read = [rows.copy() for rows in self._rows]
        for interface in (i for i in interfaces if i.treatment is not Treatment.TIED):
            target = read if interface.treatment is Treatment.READ else self._rows
            placed[id(interface)] = self._add_pairs(interface, fixed, target)
        return [placed[id(interface)] for interface in interfaces]

    def _add_pairs(
        self,
        rows: InterfaceRows,
        fixed: Sequence[Sequence[FixedDirections]],
        target: Sequence[NodeRows],
    ) -> PairCoordinates:
        pairs, b = rows.pairs, self._names.index(rows.pairs.secondary)
        nodes, vectors = pairs.secondary_local, pairs.area_vectors.copy()
        for condition in fixed[b]:
            if condition.symmetry:
                condition.cancel(vectors, nodes, self.owned_nodes(b))
        areas = np.linalg.norm(vectors, axis=1)
        normals = np.divide(
            vectors, areas[:, None], out=np.zeros_like(vectors), where=areas[:, None] > 0
        )
        slots = np.full(len(nodes), -1, dtype=np.int32)
        for turn in rows.turns():
            slots[turn] = target[b].try_add(nodes[turn], normals[turn], GRAZING)
        local, index = self._local(b, nodes, slots), np.arange(len(nodes), dtype=np.int32)
        tangents = target[b].complement(nodes)[:, : self.dimension - 1]
        tangents[slots < 0] = 0.0
        along = np.full(tangents.shape[:2], -1, dtype=np.int32)
        if rows.treatment is Treatment.SLIDING:
            for k in range(self.dimension - 1):
                there = np.flatnonzero(tangents[:, k].any(axis=1))
                free = target[b].try_add(nodes[there], tangents[there, k], PARALLEL)
                along[there, k] = self._local(b, nodes[there], free)
        return PairCoordinates(
            pairs, index, normals, areas, local, rows.treatment, tangents, along
        )

    def _tie_pairs(self, rows: InterfaceRows) -> PairCoordinates:
        """Make the relative motions that conditions leave free coordinates, and hold them."""
        pairs, b = rows.pairs, self._names.index(rows.pairs.secondary)
        nodes = pairs.secondary_local
        rest = self._rows[b].complement(nodes)
        index, normals, local = [], [], []
        for k in range(self.dimension):
            there = np.flatnonzero(rest[:, k].any(axis=1)).astype(np.int32)
            slots = self._rows[b].try_add(nodes[there], rest[there, k], PARALLEL)
            index.append(there)
            normals.append(rest[there, k])
            local.append(self._local(b, nodes[there], slots))
        held = np.concatenate(local)
        self.prescribed.append(Prescribed(held, ZERO))
        numbers = np.concatenate(index)
        areas = pairs.areas[numbers]
        none = np.zeros((len(held), 0, self.dimension))
        return PairCoordinates(
            pairs, numbers, np.concatenate(normals), areas, held, Treatment.TIED, none,
            np.zeros((len(held), 0), dtype=np.int32),
        )  # fmt: skip

    def _refuse_one_sided(self, interface: PairCoordinates, held: Sequence[NodeRows]) -> None:
        """Refuse pairs whose secondary node is held along the normal while the primary can move."""
        comm, pairs = self.layout.comm, interface.pairs
        stuck = np.flatnonzero(~interface.free & (interface.areas > 0))
        rows = held[self._names.index(pairs.secondary)]
        nodes = pairs.secondary_local[interface.index[stuck]]
        free = rows.can_add(nodes, interface.normals[stuck], GRAZING)
        stuck = stuck[~free]
        numbers = interface.index[stuck]
        mine = (pairs.primary_nodes[numbers], interface.normals[stuck], pairs.points[numbers])
        all_of = zip(*comm.allgather(mine), strict=True)
        nodes, normals, points = (np.concatenate(parts) for parts in all_of)
        b = self._names.index(pairs.primary)
        local = self.layout.dofs(b, nodes) - self.layout.first - self.layout.local_slice(b).start
        local //= self.layout.block_sizes[b]
        here = np.flatnonzero((local >= 0) & (local < self.owned_nodes(b)))
        movable = held[b].can_add(local[here], normals[here], GRAZING)
        found = [point for part in comm.allgather(points[here[movable]]) for point in part]
        if found:
            place = ", ".join(f"{x:g}" for x in found[0])
            raise CaseError(
                f"the conditions of {pairs.secondary!r} hold its node at ({place}) m along the "
                f"normal of the contact with {pairs.primary!r}, which can move there: name the "
                f"bodies of the interface the other way round, or free {pairs.secondary!r}"
            )
