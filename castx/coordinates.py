"""Coordinates in which every constraint on a node fixes one number.

At each node the displacement is read in rows of its own: directions with a prescribed value, the
motion relative to a facing node along its normal (condensed contact), and what completes them to a
basis. The coordinates v and the displacements u of all bodies are tied by the square, invertible
v = R u and u = P v, which do not depend on which pairs are closed:

    v_k = n_k · (u_secondary - u_primary)     contact: the change of the gap
    v_k = e · u                               prescribed direction
    v_k = e · (u - u_first)                   nodes of a surface that move equally: always zero

A closed pair or a prescribed displacement is then a Dirichlet condition on one entry of v, and the
contact force is the residual of that row of Pᵀ r(P v).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from mpi4py import MPI
from petsc4py import PETSc

from castx.constraints import PARALLEL, FixedDirections
from castx.errors import CaseError
from castx.layout import Layout
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


@dataclass
class _NodeRows:
    """Rows collected for the owned nodes of one body, in slots 0, 1, … of each node."""

    rows: FloatArray
    count: IntArray
    uniform: list[tuple[IntArray, IntArray]] = field(default_factory=list)

    def try_add(self, nodes: IntArray, directions: FloatArray, smallest: float) -> IntArray:
        """Add a row at each node where it is independent; return slots, -1 where it is not."""
        rest = directions.copy()
        orthonormal = self._orthonormal(nodes)
        for k in range(orthonormal.shape[1]):
            q = orthonormal[:, k]
            rest -= np.sum(rest * q, axis=1, keepdims=True) * q
        free = np.linalg.norm(rest, axis=1) > smallest
        free &= self.count[nodes] < self.rows.shape[1]
        chosen = nodes[free]
        slots = np.full(len(nodes), -1, dtype=np.int32)
        slots[free] = self.count[chosen]
        self.rows[chosen, self.count[chosen]] = directions[free]
        self.count[chosen] += 1
        return slots

    def _orthonormal(self, nodes: IntArray) -> FloatArray:
        basis = np.zeros((len(nodes), *self.rows.shape[1:]))
        for m in range(1, self.rows.shape[1] + 1):
            here = self.count[nodes] == m
            if here.any():
                q = np.linalg.qr(self.rows[nodes[here], :m].transpose(0, 2, 1))[0]
                basis[here, :m] = q.transpose(0, 2, 1)
        return basis

    def complete(self) -> IntArray:
        """Complete the rows of every node to a basis; return the nodes that have any."""
        dimension = self.rows.shape[1]
        special = np.flatnonzero(self.count).astype(np.int32)
        for m in range(1, dimension):
            nodes = special[self.count[special] == m]
            if len(nodes):
                q = np.linalg.qr(self.rows[nodes, :m].transpose(0, 2, 1), mode="complete")[0]
                self.rows[nodes, m:] = q[:, :, m:].transpose(0, 2, 1)
        return special


class Coordinates:
    """The change of coordinates of all bodies and the entries that conditions fix.

    Args:
        layout: numbering of the displacements (and pressures) of all bodies.
        body_names: names of the bodies in the order of the layout.
        dimension: number of displacement components.
        fixed: fixed directions of each body.
        pairs: node pairs of the interfaces with contact.
        condensed: whether the gaps are among the coordinates.
    """

    def __init__(
        self,
        layout: Layout,
        body_names: Sequence[str],
        dimension: int,
        fixed: Sequence[Sequence[FixedDirections]],
        pairs: Sequence[NodePairs],
        condensed: bool,
    ) -> None:
        self.layout = layout
        self._offset = int(layout.comm.exscan(layout.size_local) or 0)
        self._names = list(body_names)
        self._dimension = dimension
        self._rows = [self._empty_rows(b) for b in range(len(body_names))]
        self.prescribed: list[Prescribed] = []
        self._ties: list[tuple[int, IntArray, IntArray]] = []
        for b, conditions in enumerate(fixed):
            for condition in conditions:
                self._add_condition(b, condition)
        self.interfaces = [self._add_pairs(p, fixed, condensed) for p in pairs]
        self._condensed = condensed
        self._assemble()

    def _empty_rows(self, b: int) -> _NodeRows:
        owned = self.owned_nodes(b)
        d = self._dimension
        return _NodeRows(np.zeros((owned, d, d)), np.zeros(owned, dtype=np.int32))

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
        rows = self._rows[b] if condensed else _copy(self._rows[b])
        slots = rows.try_add(pairs.secondary_local, normals, GRAZING)
        return PairCoordinates(
            pairs, normals, areas, self._local(b, pairs.secondary_local, slots)
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


def _copy(rows: _NodeRows) -> _NodeRows:
    return _NodeRows(rows.rows.copy(), rows.count.copy())


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
