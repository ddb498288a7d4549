"""Gaps of the node pairs of all interfaces as a linear function of the displacements."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray, IntArray, LongArray
from castx.contact.kinematics.pair_rows import MidsideMotions, PairRows
from castx.contact.kinematics.rigid import RigidBody
from castx.contact.kinematics.rows import Treatment
from castx.solvers.layout import Layout


class Gaps:
    """The rows of all interfaces, one after the other, on the owners of their secondary nodes.

    g = g0 + n·(u_secondary − u_primary) (Chiumenti, section 7.1, positive when open), and what
    mid-sides add, see `castx.contact.kinematics.midside_shares`.

    Attributes:
        at_rest: gaps without displacement of any body [m], shape (rows,).
        initial: gaps without displacement of deformable bodies [m], shape (rows,).
        local: local number of each gap in v, -1 where none is free, shape (rows,).
        tied: rows of tied pairs, which never open, shape (rows,).
        free: rows that may open and close, shape (rows,).
        areas: contact areas [m²], shape (rows,).
        slices: where the rows of each interface are.
        primary_motion: present displacements of rigid primary bodies [m], shape (rows,
            dimension).

    Args:
        layout: numbering of the displacements of all bodies.
        body_names: names of the bodies and of their mid-sides in the order of the layout; other
            bodies are rigid.
        interfaces: rows of the pairs of each interface.
        rigid: rigid bodies by name.
    """

    def __init__(
        self,
        layout: Layout,
        body_names: Sequence[str],
        interfaces: Sequence[PairRows],
        rigid: Mapping[str, RigidBody],
    ) -> None:
        self.interfaces, self._rigid = list(interfaces), dict(rigid)
        self.at_rest = _joined([i.pairs.gap[i.index] for i in interfaces])
        self.local = _joined([i.local for i in interfaces], np.int32)
        self.tied = _joined(
            [np.full(len(i.local), i.treatment is Treatment.TIED) for i in interfaces], np.bool_
        )
        self.at_rest[self.tied] = 0.0
        self.free = (self.local >= 0) & ~self.tied
        self.areas = _joined([i.areas for i in interfaces])
        ends = np.cumsum([0, *(len(i.local) for i in interfaces)])
        self.slices = [slice(a, b) for a, b in pairwise(ends)]
        dimension = max((i.normals.shape[1] for i in interfaces), default=0)
        self.primary_motion = np.zeros((len(self.local), dimension))
        self.initial = self.at_rest.copy()
        self.set_time(0.0)
        self.matrix = self._assemble(layout, list(body_names))
        self._values = self.matrix.createVecLeft()

    def _assemble(self, layout: Layout, names: list[str]) -> PETSc.Mat:
        n = len(self.local)
        sizes = ((n, PETSc.DETERMINE), (layout.size_local, layout.size_global))
        B = PETSc.Mat().createAIJ(sizes, nnz=8, comm=layout.comm)
        B.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        first = B.getOwnershipRange()[0]
        for part, interface in zip(self.slices, self.interfaces, strict=True):
            rows = first + np.arange(part.start, part.stop, dtype=np.int32)
            pairs, index = interface.pairs, interface.index
            nodes, weights = pairs.partners
            own = (pairs.secondary, pairs.secondary_nodes[:, None], np.ones((len(nodes), 1)))
            for name, numbers, shares in (own, (pairs.primary, nodes, -weights)):
                if name in names:
                    b = names.index(name)
                    fill_directions(
                        B, layout, b, rows, numbers[index], shares[index], interface.normals
                    )
            fill_midsides(B, layout, names, rows, interface.midsides_in_gaps())
        B.assemble()
        return B

    def set_time(self, time: float) -> None:
        """Move rigid bodies to their places at a time [s]."""
        self.initial[:] = self.at_rest
        for part, interface in zip(self.slices, self.interfaces, strict=True):
            rigid = self._rigid.get(interface.pairs.primary)
            if rigid is not None:
                self.primary_motion[part] = rigid.displacement(time)
                moved = np.sum(interface.normals * self.primary_motion[part], axis=1)
                self.initial[part] = self.at_rest[part] - moved

    def place_new_bodies(self, u: FloatArray, renewed: Collection[str]) -> None:
        """Count the gaps of new bodies from the present places of the others; collective.

        Args:
            u: owned displacements of all bodies, none of the new ones.
            renewed: names of the new bodies.
        """
        changes = self.changes(u)
        for part, interface in zip(self.slices, self.interfaces, strict=True):
            if not {interface.pairs.secondary, interface.pairs.primary}.isdisjoint(renewed):
                self.at_rest[part] -= changes[part]
                self.initial[part] -= changes[part]

    def changes(self, u: FloatArray) -> FloatArray:
        """Return the changes of the gaps by owned displacements [m], shape (rows,); collective."""
        displacements = self.matrix.createVecRight()
        displacements.array[:] = u
        self.matrix.mult(displacements, self._values)
        displacements.destroy()
        return np.array(self._values.array_r)

    def values(self, u: PETSc.Vec) -> FloatArray:
        """Return the gaps at the displacements u [m], shape (rows,)."""
        self.matrix.mult(u, self._values)
        return np.asarray(self._values.array_r + self.initial)

    def signatures(self) -> FloatArray:
        """Return a number in (0, 1) for each row that depends on its place and direction alone.

        The order of the bodies, which turns the normal round, does not change it.
        """
        place = [
            i.pairs.points[i.index] @ np.array([12.9898, 78.233, 37.719])[: i.normals.shape[1]]
            + (i.normals @ np.array([3.1, 5.3, 7.7])[: i.normals.shape[1]]) ** 2
            for i in self.interfaces
        ]
        # Fractional part of a large multiple of a sine: the usual pseudo-random number of shaders,
        # of unknown origin, with its factors 12.9898, 78.233 and 43758.5453. The others, and the
        # factor 1e3 for places in metres, are any numbers that are no multiples of each other.
        sine = np.sin(_joined(place) * 1e3)
        return np.abs(sine * 43758.5453 % 1.0)


def fill_directions(
    B: PETSc.Mat,
    layout: Layout,
    b: int,
    rows: IntArray,
    nodes: LongArray,
    weights: FloatArray,
    directions: FloatArray,
) -> None:
    """Add to each row Σ_j w_j d · u_j of nodes of a body, or of mid-sides.

    Args:
        B: the matrix.
        layout: numbering of its columns.
        b: number of the body.
        rows: global numbers of rows of this rank, shape (n,).
        nodes: global node numbers, shape (n, corners).
        weights: of the nodes, shape (n, corners).
        directions: shape (n, dimension).
    """
    for k in range(directions.shape[1]):
        columns = layout.dofs(b, nodes, k)
        values = weights * directions[:, k, None]
        for row, numbers, entries in zip(rows, columns, values, strict=True):
            B.setValues(row, numbers, entries, PETSc.InsertMode.ADD_VALUES)


def fill_midsides(
    B: PETSc.Mat,
    layout: Layout,
    names: Sequence[str],
    rows: IntArray,
    motions: Iterable[MidsideMotions],
) -> None:
    """Add the motions of mid-sides to the rows of an interface.

    Args:
        B: the matrix.
        layout: numbering of its columns.
        names: of the bodies and mid-sides in the order of the layout.
        rows: global numbers of the rows of the interface, -1 of those that B lacks, shape (rows,).
        motions: of its rows.
    """
    for name, place, midsides, weights, directions in motions:
        there, b = rows[place] >= 0, names.index(name)
        fill_directions(
            B, layout, b, rows[place[there]], midsides[there, None], weights[there, None],
            directions[there],
        )  # fmt: skip


def _joined(
    parts: Sequence[npt.NDArray[Any]], dtype: npt.DTypeLike = np.float64
) -> npt.NDArray[Any]:
    return np.concatenate([np.zeros(0, dtype=dtype), *parts])
