"""Rows of the nodes of all bodies: prescribed directions first, then tied and touching pairs."""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.contact.kinematics.node_rows import NodeRows, owned_nodes
from castx.contact.kinematics.pair_rows import EqualMotion, PairRows, Prescribed
from castx.contact.kinematics.rows import InterfaceRows, Treatment
from castx.contact.kinematics.tied_ends import HELD, MOVABLE, at_tied_nodes, lead, motions_faced
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.mechanics.fixed_directions import PARALLEL, ZERO, FixedDirections
from castx.solvers.layout import Layout

GRAZING = 0.05
"""Sine of the smallest angle at which a node with fixed directions can still leave its partner."""


class RowPlacement:
    """The rows of the nodes of all bodies, added one condition and one interface after the other.

    Attributes:
        rows: rows of the nodes of each body.
        prescribed: entries of v that conditions prescribe.
        equal_motions: of the surfaces that move equally.
        interfaces: rows of the pairs of each interface.

    Args:
        layout: numbering of the displacements (and pressures) of all bodies.
        body_names: names of the bodies in the order of the layout.
        dimension: number of displacement components.
        fixed: fixed directions of each body.
        interfaces: the interfaces with contact; a primary body without unknowns is rigid.

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
    ) -> None:
        self._layout, self._names, self._dimension = layout, list(body_names), dimension
        self.rows = [
            NodeRows.none(owned_nodes(layout, b), dimension) for b in range(len(body_names))
        ]
        self.prescribed: list[Prescribed] = []
        self.equal_motions: list[EqualMotion] = []
        self._held: list[EqualMotion] = []
        for b, conditions in enumerate(fixed):
            for condition in conditions:
                self._add_condition(b, condition)
        self._constrained = [rows.copy() for rows in self.rows]
        self.interfaces = self._add_interfaces(interfaces, fixed)
        for interface in self.interfaces:
            if interface.pairs.primary in self._names:
                self._refuse_one_sided(interface, self._constrained)

    def _local(self, b: int, nodes: IntArray, slots: IntArray) -> IntArray:
        start, size = self._layout.local_slice(b).start, self._layout.block_sizes[b]
        return np.where(slots < 0, -1, start + nodes * size + slots).astype(np.int32)

    def _add_condition(self, b: int, condition: FixedDirections) -> None:
        slots = self.rows[b].try_add(condition.nodes, condition.directions, PARALLEL)
        kept = slots >= 0
        local = self._local(b, condition.nodes[kept], slots[kept])
        if condition.value is None:
            self._refuse_prescribed(b, condition, ~kept)
            ranks = self._layout.comm.allgather(len(slots) > 0)
            first = 0 if any(ranks) and ranks.index(True) == self._layout.comm.rank else None
            self.equal_motions.append(EqualMotion(b, condition.nodes, slots, first))
        else:
            self.prescribed.append(Prescribed(local, condition.value))
            if not condition.symmetry:
                self._held.append(EqualMotion(b, condition.nodes[kept], slots[kept]))

    def _refuse_prescribed(self, b: int, condition: FixedDirections, prescribed: BoolArray) -> None:
        if self._layout.comm.allreduce(bool(prescribed.any()), op=MPI.LOR):
            raise CaseError(
                f"{condition.name} is uniform, but another condition on {self._names[b]!r} "
                "prescribes this direction at some of its nodes; leave one of them out"
            )

    def _add_interfaces(
        self, interfaces: Sequence[InterfaceRows], fixed: Sequence[Sequence[FixedDirections]]
    ) -> list[PairRows]:
        """Add the rows of all interfaces, tied ones first: a tied node has no gap."""
        placed = {}
        tied = [i for i in interfaces if i.treatment is Treatment.TIED]
        for interface in tied:
            placed[id(interface)] = self._tie_pairs(interface)
        apart = [rows.copy() for rows in self.rows]
        for interface in (i for i in interfaces if i.treatment is not Treatment.TIED):
            target = apart if interface.treatment is Treatment.UNCHANGED else self.rows
            placed[id(interface)] = self._add_pairs(interface, fixed, target)
        return [placed[id(interface)] for interface in interfaces]

    def _add_pairs(
        self,
        rows: InterfaceRows,
        fixed: Sequence[Sequence[FixedDirections]],
        target: Sequence[NodeRows],
    ) -> PairRows:
        pairs, b = rows.pairs, self._names.index(rows.pairs.secondary)
        nodes = pairs.secondary_local
        normals, areas = self._normals(rows, b, fixed[b])
        slots = np.full(len(nodes), -1, dtype=np.int32)
        for numbers in rows.by_order_at_node():
            slots[numbers] = target[b].try_add(nodes[numbers], normals[numbers], GRAZING)
        local, index = self._local(b, nodes, slots), np.arange(len(nodes), dtype=np.int32)
        tangents = target[b].complement(nodes)[:, : self._dimension - 1]
        tangents[slots < 0] = 0.0
        along = np.full(tangents.shape[:2], -1, dtype=np.int32)
        if rows.treatment is Treatment.SLIDING:
            for k in range(self._dimension - 1):
                there = np.flatnonzero(tangents[:, k].any(axis=1))
                free = target[b].try_add(nodes[there], tangents[there, k], PARALLEL)
                along[there, k] = self._local(b, nodes[there], free)
        return PairRows(
            pairs, index, normals, areas, local, rows.treatment, tangents, along, rows.midsides,
            rows.facets,
        )  # fmt: skip

    def _normals(
        self, rows: InterfaceRows, b: int, fixed: Sequence[FixedDirections]
    ) -> tuple[FloatArray, FloatArray]:
        """Return the normals of pairs, which lie in the symmetry planes, and their areas."""
        nodes, vectors = rows.pairs.secondary_local, rows.pairs.area_vectors.copy()
        for condition in fixed:
            if condition.symmetry:
                condition.cancel(vectors, nodes, owned_nodes(self._layout, b))
        areas = np.linalg.norm(vectors, axis=1)
        normals = np.divide(
            vectors, areas[:, None], out=np.zeros_like(vectors), where=areas[:, None] > 0
        )
        return normals, areas

    def _tie_pairs(self, rows: InterfaceRows) -> PairRows:
        """Make relative motions that are still free unknowns of their own and fix them at zero."""
        pairs, b = rows.pairs, self._names.index(rows.pairs.secondary)
        nodes = pairs.secondary_local
        rest = self.rows[b].complement(nodes)
        index, normals, local = [], [], []
        for k in range(self._dimension):
            there = np.flatnonzero(rest[:, k].any(axis=1)).astype(np.int32)
            slots = self.rows[b].try_add(nodes[there], rest[there, k], PARALLEL)
            index.append(there)
            normals.append(rest[there, k])
            local.append(self._local(b, nodes[there], slots))
        self._refuse_held(pairs, b)
        for motion in (motion for motion in self.equal_motions if motion.body == b):
            led, direction, slots = self._lead(motion, pairs, b)
            index.append(led)
            normals.append(direction)
            local.append(self._local(b, nodes[led], slots))
        fixed = np.concatenate(local)
        self.prescribed.append(Prescribed(fixed, ZERO))
        numbers = np.concatenate(index)
        areas = pairs.areas[numbers]
        none = np.zeros((len(fixed), 0, self._dimension))
        return PairRows(
            pairs, numbers, np.concatenate(normals), areas, fixed, Treatment.TIED, none,
            np.zeros((len(fixed), 0), dtype=np.int32),
        )  # fmt: skip

    def _lead(
        self, motion: EqualMotion, pairs: NodePairs, b: int
    ) -> tuple[IntArray, FloatArray, IntArray]:
        """Let a tied node lead a surface; return its pair, direction and row on its rank.

        Raises:
            CaseError: others are tied too, to points that do not move equally.
        """
        at, numbers = lead(motion, pairs, self._names[b], self._layout)
        directions = self.rows[b].rows[motion.nodes[at], motion.slots[at]]
        tied = self._layout.comm.allreduce(len(at))
        if tied > 1 and pairs.primary in self._names:
            faced = self._faced(pairs, numbers, directions)
            if MOVABLE in faced or len(set(faced)) > 1:
                raise CaseError(
                    f"a uniform surface of {self._names[b]!r} is tied to {pairs.primary!r} at "
                    f"{tied} nodes: the surface of {pairs.primary!r} that continues it must move "
                    "as one too; give it the same condition"
                )
        mine = int(motion.first is not None and motion.tied_by is pairs)
        return numbers[:mine], directions[:mine], motion.slots[at[:mine]]

    def _refuse_held(self, pairs: NodePairs, b: int) -> None:
        """Refuse tied nodes that a condition holds where the body that they are tied to moves."""
        if pairs.primary not in self._names:
            return
        for held in (held for held in self._held if held.body == b):
            at, numbers = at_tied_nodes(held, pairs)
            directions = self.rows[b].rows[held.nodes[at], held.slots[at]]
            if np.any(self._faced(pairs, numbers, directions) != HELD):
                raise CaseError(
                    f"a condition holds nodes of {self._names[b]!r} that are tied to "
                    f"{pairs.primary!r}, which can move there: name the bodies of the interface "
                    f"the other way round, or give {pairs.primary!r} the same condition"
                )

    def _faced(self, pairs: NodePairs, numbers: IntArray, directions: FloatArray) -> IntArray:
        primary = self._names.index(pairs.primary)
        return motions_faced(
            pairs, numbers, directions, primary, self._layout, self._constrained[primary],
            self.equal_motions,
        )  # fmt: skip

    def _refuse_one_sided(self, interface: PairRows, constrained: Sequence[NodeRows]) -> None:
        """Refuse pairs whose secondary node is fixed along the normal but the primary can move."""
        comm, pairs = self._layout.comm, interface.pairs
        stuck = np.flatnonzero(~interface.free & (interface.areas > 0))
        rows = constrained[self._names.index(pairs.secondary)]
        nodes = pairs.secondary_local[interface.index[stuck]]
        free = rows.can_add(nodes, interface.normals[stuck], GRAZING)
        stuck = stuck[~free]
        numbers = interface.index[stuck]
        mine = (pairs.primary_nodes[numbers], interface.normals[stuck], pairs.points[numbers])
        all_of = zip(*comm.allgather(mine), strict=True)
        nodes, normals, points = (np.concatenate(parts) for parts in all_of)
        b = self._names.index(pairs.primary)
        local = self._layout.dofs(b, nodes) - self._layout.first - self._layout.local_slice(b).start
        local //= self._layout.block_sizes[b]
        here = np.flatnonzero((local >= 0) & (local < owned_nodes(self._layout, b)))
        movable = constrained[b].can_add(local[here], normals[here], GRAZING)
        found = [point for part in comm.allgather(points[here[movable]]) for point in part]
        if found:
            place = ", ".join(f"{x:g}" for x in found[0])
            raise CaseError(
                f"the conditions of {pairs.secondary!r} hold its node at ({place}) m along the "
                f"normal of the contact with {pairs.primary!r}, which can move there: name the "
                f"bodies of the interface the other way round, or free {pairs.secondary!r}"
            )
