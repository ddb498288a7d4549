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
import numpy.typing as npt

from castx.constraints import PARALLEL, FixedDirections
from castx.errors import CaseError
from castx.layout import Layout
from castx.node_rows import NodeRows
from castx.pairs import NodePairs
from castx.tables import Table

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int32]

GRAZING = 0.05
"""Sine of the smallest angle at which a node with fixed directions can still leave its partner."""


@dataclass(frozen=True)
class Prescribed:
    """Owned entries of v that a condition prescribes, with their displacement over time [m]."""

    local: IntArray
    value: Table


@dataclass(frozen=True)
class PairCoordinates:
    """Where the pairs of one interface live.

    Attributes:
        pairs: the node pairs.
        normals: normals that respect the symmetry planes, shape (n, dimension).
        areas: contact areas [m²] that turn forces into pressures, shape (n,).
        local: local number in v of each pair's gap, shape (n,); -1 where no normal motion is free.
    """

    pairs: NodePairs
    normals: FloatArray
    areas: FloatArray
    local: IntArray

    @property
    def free(self) -> npt.NDArray[np.bool_]:
        """Which pairs carry a constraint."""
        return self.local >= 0


class Coordinates:
    """The change of coordinates of all bodies and the entries that conditions fix.

    Args:
        layout: numbering of the displacements (and pressures) of all bodies.
        body_names: names of the bodies in the order of the layout.
        dimension: number of displacement components.
        fixed: fixed directions of each body.
        pairs: node pairs of the interfaces with contact.
        condensed: whether the gaps are among the coordinates.
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
        pairs: Sequence[NodePairs],
        condensed: bool,
        uniform: Sequence[int | None] = (),
    ) -> None:
        self.layout = layout
        self._uniform = [(b, k) for b, k in enumerate(uniform) if k is not None]
        self._offset = _first_owned(layout)
        self._names = list(body_names)
        self._dimension = dimension
        self._rows = [
            NodeRows.none(self.owned_nodes(b), dimension) for b in range(len(body_names))
        ]
        self.prescribed: list[Prescribed] = []
        self._ties: list[tuple[int, IntArray, IntArray]] = []
        for b, conditions in enumerate(fixed):
            for condition in conditions:
                self._add_condition(b, condition)
        held = [rows.copy() for rows in self._rows]
        self.interfaces = [self._add_pairs(p, fixed, condensed) for p in pairs]
        for interface in self.interfaces:
            self._refuse_one_sided(interface, held)
        self._condensed = condensed
        self._assemble()

    def owned_nodes(self, b: int) -> int:
        """Return the number of nodes of a body that this rank owns."""
        part = self.layout.local_slice(b)
        return (part.stop - part.start) // self.layout.block_sizes[b]

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
        self, b: int, condition: FixedDirections, held: npt.NDArray[np.bool_]
    ) -> None:
        if self.layout.comm.allreduce(bool(held.any()), op=MPI.LOR):
            raise CaseError(
                f"{condition.name} is uniform, but another condition on {self._names[b]!r} "
                "prescribes this direction at some of its nodes; leave one of them out"
            )

    def _add_pairs(
        self, pairs: NodePairs, fixed: Sequence[Sequence[FixedDirections]], condensed: bool
    ) -> PairCoordinates:
        b = self._names.index(pairs.secondary)
        vectors = pairs.area_vectors.copy()
        for condition in fixed[b]:
            if condition.symmetry:
                condition.cancel(vectors, pairs.secondary_local, self.owned_nodes(b))
        areas = np.linalg.norm(vectors, axis=1)
        normals = np.divide(
            vectors, areas[:, None], out=np.zeros_like(vectors), where=areas[:, None] > 0
        )
        rows = self._rows[b] if condensed else self._rows[b].copy()
        slots = rows.try_add(pairs.secondary_local, normals, GRAZING)
        return PairCoordinates(
            pairs, normals, areas, self._local(b, pairs.secondary_local, slots)
        )

    def _refuse_one_sided(self, interface: PairCoordinates, held: Sequence[NodeRows]) -> None:
        """Refuse pairs whose secondary node is held along the normal while the primary can move."""
        comm, pairs = self.layout.comm, interface.pairs
        stuck = np.flatnonzero(~interface.free & (interface.areas > 0))
        rows = held[self._names.index(pairs.secondary)].copy()
        free = rows.try_add(pairs.secondary_local[stuck], interface.normals[stuck], GRAZING) >= 0
        stuck = stuck[~free]
        mine = (pairs.primary_nodes[stuck], interface.normals[stuck], pairs.points[stuck])
        all_of = zip(*comm.allgather(mine), strict=True)
        nodes, normals, points = (np.concatenate(parts) for parts in all_of)
        b = self._names.index(pairs.primary)
        local = self.layout.dofs(b, nodes) - self._offset - self.layout.local_slice(b).start
        local //= self.layout.block_sizes[b]
        here = np.flatnonzero((local >= 0) & (local < self.owned_nodes(b)))
        slots = held[b].copy().try_add(local[here], normals[here], GRAZING)
        found = [point for part in comm.allgather(points[here[slots >= 0]]) for point in part]
        if found:
            place = ", ".join(f"{x:g}" for x in found[0])
            raise CaseError(
                f"the conditions of {pairs.secondary!r} hold its node at ({place}) m along the "
                f"normal of the contact with {pairs.primary!r}, which can move there: name the "
                f"bodies of the interface the other way round, or free {pairs.secondary!r}"
            )

    def _assemble(self) -> None:
        local_size, size = self.layout.size_local, self.layout.size_global
        sizes = ((local_size, size), (local_size, size))
        comm = self.layout.comm
        forward = PETSc.Mat().createAIJ(sizes, nnz=12, comm=comm)
        frames = PETSc.Mat().createAIJ(sizes, nnz=12, comm=comm)
        contact = PETSc.Mat().createAIJ(sizes, nnz=12, comm=comm)
        for matrix in (forward, frames, contact):
            matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        ones = forward.createVecLeft()
        ones.set(1.0)
        forward.setDiagonal(ones)
        frames.setDiagonal(ones)
        inverses = [self._fill_frames(b, forward, frames) for b in range(len(self._names))]
        self._fill_ties(forward, frames, inverses)
        self._fill_uniform(forward, frames)
        if self._condensed:
            for interface in self.interfaces:
                self._fill_contact(interface, forward, contact, inverses)
        for matrix in (forward, frames, contact):
            matrix.assemble()
        self.to_coordinates = forward
        self.to_displacements = _sum_of_powers(contact, frames)
        contact.destroy()

    def _fill_frames(self, b: int, forward: PETSc.Mat, frames: PETSc.Mat) -> FloatArray:
        rows, d, size = self._rows[b], self._dimension, self.layout.block_sizes[b]
        first = self._offset + self.layout.local_slice(b).start
        inverse = np.tile(np.eye(d), (self.owned_nodes(b), 1, 1))
        special = rows.complete()
        inverse[special] = np.linalg.inv(rows.rows[special])
        for i in special:
            dofs = (first + i * size + np.arange(d)).astype(np.int32)
            forward.setValues(dofs, dofs, rows.rows[i])
            frames.setValues(dofs, dofs, inverse[i])
        return inverse

    def _fill_ties(
        self, forward: PETSc.Mat, frames: PETSc.Mat, inverses: Sequence[FloatArray]
    ) -> None:
        comm, d = self.layout.comm, self._dimension
        for b, nodes, slots in self._ties:
            if comm.allreduce(len(nodes), op=MPI.SUM) == 0:
                continue
            own = self._local(b, nodes, slots) + self._offset
            starts = (own - slots)[:, None] + np.arange(d, dtype=np.int32)
            rows = self._rows[b].rows[nodes, slots]
            leaders = comm.allgather((own[0], starts[0], rows[0]) if len(own) else None)
            first, columns, row = next(leader for leader in leaders if leader is not None)
            others = np.flatnonzero(own != first)
            for i in others:
                forward.setValues(own[i], columns, -row)
                frames.setValues(starts[i], first, inverses[b][nodes[i]][:, slots[i]])
            local = self._local(b, nodes[others], slots[others])
            self.prescribed.append(Prescribed(local, Table.constant(0.0)))

    def _fill_uniform(self, forward: PETSc.Mat, frames: PETSc.Mat) -> None:
        """Tie components to that of the first node: v = w - w_first, zero at all others."""
        for b, k in self._uniform:
            nodes = np.arange(self.owned_nodes(b), dtype=np.int32)
            own = self._local(b, nodes, np.full(len(nodes), k)) + self._offset
            firsts = self.layout.comm.allgather(own[0] if len(own) else None)
            first = next(number for number in firsts if number is not None)
            others = own[own != first]
            for row in others:
                forward.setValue(row, first, -1.0)
                frames.setValue(row, first, 1.0)
            self.prescribed.append(
                Prescribed((others - self._offset).astype(np.int32), Table.constant(0.0))
            )

    def _fill_contact(
        self,
        interface: PairCoordinates,
        forward: PETSc.Mat,
        contact: PETSc.Mat,
        inverses: Sequence[FloatArray],
    ) -> None:
        pairs, d = interface.pairs, self._dimension
        b, primary = self._names.index(pairs.secondary), self._names.index(pairs.primary)
        offset, size = self._offset, self.layout.block_sizes[b]
        start = self.layout.local_slice(b).start
        columns = np.stack(
            [self.layout.dofs(primary, pairs.primary_nodes, k) for k in range(d)], axis=1
        ).astype(np.int32)
        for i in np.flatnonzero(interface.free):
            node, n = pairs.secondary_local[i], interface.normals[i]
            first = start + node * size
            slot = interface.local[i] - first
            forward.setValues(np.int32(interface.local[i] + offset), columns[i], -n)
            rows = (first + offset + np.arange(d)).astype(np.int32)
            contact.setValues(rows, columns[i], np.outer(inverses[b][node][:, slot], n))


def _first_owned(layout: Layout) -> int:
    vector = layout.create_vector()
    first = vector.getOwnershipRange()[0]
    vector.destroy()
    return int(first)


def _sum_of_powers(contact: PETSc.Mat, frames: PETSc.Mat) -> PETSc.Mat:
    """Return (1 + C + C² + …) frames; C is nilpotent since no chain of pairs returns to itself."""
    total, term = frames.copy(), frames
    while contact.norm() > 0:
        following = contact.matMult(term)
        term.destroy()
        term = following
        if term.norm() == 0:
            break
        total.axpy(1.0, term)
    term.destroy()
    return total
