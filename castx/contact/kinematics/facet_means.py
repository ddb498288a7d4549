"""Means of the forces of pairs over the facets round them.

The forces of nodes are those of tractions only in the mean: where a skin is thinner than a cell,
those of neighbours differ by more than their mean, with the way in which the cells are cut. With
t = F/A of the nodes of a facet f and a_fi the part that node i has in its area,

    t_f = Σ_i a_fi t_i/Σ_i a_fi,   F_i = A_i Σ_f a_fi t_f/Σ_f a_fi

is a traction that is constant on the facet, and what a node has of those round it. On facets of
equal size it leaves nothing of forces that alternate from node to node, and sums stay as they are.
"""

from __future__ import annotations

from collections.abc import Callable

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray, LongArray
from castx.contact.kinematics.gaps import Gaps
from castx.domain.pairs.facet_pairs import FacetPairs


class FacetMeans:
    """Means over the facets of those interfaces that have some.

    Args:
        comm: communicator of the pairs.
        gaps: the pairs of all interfaces.
    """

    def __init__(self, comm: MPI.Intracomm, gaps: Gaps) -> None:
        count = len(gaps.local)
        self._areas = gaps.areas
        first, _ = gaps.matrix.getOwnershipRange()
        found = [
            _own_facets(comm, interface.facets, first + part.start, part.stop - part.start)
            for part, interface in zip(gaps.slices, gaps.interfaces, strict=True)
            if interface.facets is not None
        ]
        self._parts = _matrix(comm, count, found)
        self._at_rows, self._at_facets = self._parts.createVecs()

    def forces(self, forces: FloatArray, counted: BoolArray) -> FloatArray:
        """Return forces of which those of some pairs are means over these; collective.

        Args:
            forces: of the pairs [N], shape (pairs,).
            counted: pairs that have a mean, and are in it, shape (pairs,).
        """
        counted = counted & (self._areas > 0.0)
        tractions = np.divide(forces, self._areas, out=np.zeros_like(forces), where=counted)
        weights = self._over_facets(counted.astype(np.float64))
        some = weights > 0.0
        means = np.divide(
            self._over_facets(tractions), weights, out=np.zeros_like(weights), where=some
        )
        total, around = self._at_pairs(means), self._at_pairs(some.astype(np.float64))
        within = counted & (around > 0.0)
        return np.divide(self._areas * total, around, out=forces.copy(), where=within)

    def amid(self, marked: BoolArray) -> BoolArray:
        """Return the pairs round which all pairs of their facets are marked; collective.

        Args:
            marked: shape (pairs,).
        """
        others = self._over_facets((~marked).astype(np.float64))
        return np.asarray(marked & (self._at_pairs(others) <= 0.0))

    def _over_facets(self, values: FloatArray) -> FloatArray:
        return _product(self._parts.mult, self._at_rows, values, self._at_facets)

    def _at_pairs(self, values: FloatArray) -> FloatArray:
        return _product(self._parts.multTranspose, self._at_facets, values, self._at_rows)

    def destroy(self) -> None:
        """Destroy the PETSc objects."""
        for each in (self._parts, self._at_rows, self._at_facets):
            each.destroy()


def _product(
    multiply: Callable[[PETSc.Vec, PETSc.Vec], None],
    x: PETSc.Vec,
    values: FloatArray,
    y: PETSc.Vec,
) -> FloatArray:
    x.array[:] = values
    multiply(x, y)
    return np.asarray(y.array_r.copy())


def _own_facets(
    comm: MPI.Intracomm, found: FacetPairs, first: int, count: int
) -> tuple[LongArray, FloatArray]:
    """Return the pairs at the corners of facets of this rank, and the corners' areas; collective.

    Args:
        comm: communicator of the pairs.
        found: facets of an interface.
        first: number of its first pair of this rank among those of all interfaces and ranks.
        count: of its pairs of this rank.

    Returns:
        Numbers among those of all ranks, -1 where there is none, and areas [m²], both of shape
        (facets, corners).
    """
    of_labels = np.where(found.pairs >= 0, first + found.pairs, -1)
    comm.Allreduce(MPI.IN_PLACE, of_labels, op=MPI.MAX)
    numbers = of_labels[found.labels]
    last = numbers.max(axis=1, initial=-1)
    here = (last >= first) & (last < first + count)
    return numbers[here], found.facets.areas[here]


def _matrix(
    comm: MPI.Intracomm, count: int, facets: list[tuple[LongArray, FloatArray]]
) -> PETSc.Mat:
    """Return the parts that pairs have in the areas of facets, shape (facets, pairs)."""
    lengths, columns, values = [np.zeros(1, dtype=PETSc.IntType)], [], []
    for numbers, areas in facets:
        order = np.argsort(numbers, axis=1)
        in_order = np.take_along_axis(numbers, order, axis=1)
        there = in_order >= 0
        lengths.append(there.sum(axis=1))
        columns.append(in_order[there])
        values.append(np.take_along_axis(areas, order, axis=1)[there])
    starts = np.cumsum(np.concatenate(lengths)).astype(PETSc.IntType)
    csr = (starts, np.concatenate(columns).astype(PETSc.IntType), np.concatenate(values))
    sizes = ((len(starts) - 1, PETSc.DETERMINE), (count, PETSc.DETERMINE))
    return PETSc.Mat().createAIJ(sizes, csr=csr, comm=comm)
