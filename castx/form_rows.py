"""Bilinear forms assembled into block rows, from which PETSc takes whole rows at once."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
from dolfinx import fem


class FormRows:
    """The rows of the matrix of a bilinear form on one space.

    PETSc looks for the place of every number that a cell adds. In block rows all numbers of two
    nodes have one place, and a finished row goes to PETSc as it is: less than half of the cost,
    for the same bits.

    Args:
        form: on a space with one block size.
    """

    def __init__(self, form: fem.Form) -> None:
        self._form, self._blocks = form, fem.create_matrix(form)
        nodes = self._blocks.index_map(0)
        pointers = self._blocks.indptr[: nodes.size_local + 1]
        self._count, self._size = int(pointers[-1]), int(self._blocks.block_size[0])
        components = np.arange(self._size)
        first = nodes.local_range[0] + np.arange(nodes.size_local)
        self._rows = (first * self._size).astype(PETSc.IntType)
        self._pointers = (pointers * self._size).astype(PETSc.IntType)
        local = self._blocks.indices[: self._count].astype(np.int32)
        numbers = self._blocks.index_map(1).local_to_global(local)
        columns = numbers[:, None] * self._size + components
        self._columns = columns.ravel().astype(PETSc.IntType)

    def assemble(self, A: PETSc.Mat) -> None:
        """Assemble the form into a matrix that has its pattern; collective."""
        blocks, size = self._blocks, self._size
        blocks.data[:] = 0.0
        fem.assemble_matrix(blocks, self._form)  # type: ignore[arg-type]
        blocks.scatter_reverse()
        values = blocks.data[: self._count * size**2].reshape(self._count, size, size)
        insert = PETSc.InsertMode.INSERT_VALUES
        for k in range(size):
            rows = self._rows + PETSc.IntType(k)
            A.setValuesIJV(self._pointers, self._columns, values[:, k].ravel(), insert, rows)
        A.assemble()
