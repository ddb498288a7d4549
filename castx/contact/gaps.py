"""Gaps of the node pairs of all interfaces as a linear function of the displacements."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from petsc4py import PETSc

import numpy as np
import numpy.typing as npt

from castx.coordinates import PairCoordinates
from castx.layout import Layout

FloatArray = npt.NDArray[np.float64]


class Gaps:
    """The pairs of all interfaces, one after the other, on the owners of their secondary nodes.

    Args:
        layout: numbering of the displacements of all bodies.
        body_names: names of the bodies in the order of the layout.
        interfaces: coordinates of the pairs of each interface.
        initial: gaps without displacement of each interface [m].
    """

    def __init__(
        self,
        layout: Layout,
        body_names: Sequence[str],
        interfaces: Sequence[PairCoordinates],
        initial: Sequence[FloatArray],
    ) -> None:
        self.interfaces = list(interfaces)
        self.initial = np.concatenate([np.zeros(0), *initial])
        none = np.zeros(0, dtype=np.int32)
        self.local = np.concatenate([none, *(i.local for i in interfaces)])
        self.free = self.local >= 0
        self.areas = np.concatenate([np.zeros(0), *(i.areas for i in interfaces)])
        ends = np.cumsum([0, *(len(i.local) for i in interfaces)])
        self.slices = [slice(a, b) for a, b in pairwise(ends)]
        self.matrix = self._assemble(layout, list(body_names))
        self._values = self.matrix.createVecLeft()

    def _assemble(self, layout: Layout, names: list[str]) -> PETSc.Mat:
        n = len(self.local)
        sizes = ((n, PETSc.DETERMINE), (layout.size_local, layout.size_global))
        B = PETSc.Mat().createAIJ(sizes, nnz=8, comm=layout.comm)
        B.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        first = B.getOwnershipRange()[0]
        for part, interface in zip(self.slices, self.interfaces, strict=True):
            pairs, normals = interface.pairs, interface.normals
            rows = first + np.arange(part.start, part.stop, dtype=np.int32)
            sides = ((pairs.secondary, pairs.secondary_nodes, 1.0),
                     (pairs.primary, pairs.primary_nodes, -1.0))
            for name, nodes, sign in sides:
                for k in range(normals.shape[1]):
                    columns = layout.dofs(names.index(name), nodes, k)
                    for row, column, value in zip(rows, columns, normals[:, k], strict=True):
                        B.setValue(row, np.int32(column), sign * value)
        B.assemble()
        return B

    def values(self, u: PETSc.Vec) -> FloatArray:
        """Return the gaps at the displacements u [m], shape (pairs,)."""
        self.matrix.mult(u, self._values)
        return np.asarray(self._values.array_r + self.initial)

    def keys(self) -> FloatArray:
        """Return a number in (0, 1) for each pair that depends on nothing but its place."""
        place = [i.pairs.points @ np.array([12.9898, 78.233, 37.719][: i.pairs.points.shape[1]])
                 for i in self.interfaces]
        sine = np.sin(np.concatenate([np.zeros(0), *place]) * 1e3)
        return np.abs(sine * 43758.5453 % 1.0)
