"""Entries of a distributed vector that a rank needs or feeds, whoever owns them."""

from __future__ import annotations

from petsc4py import PETSc

import numpy.typing as npt

from castx.arrays import FloatArray


class RemoteEntries:
    """Entries of the vectors of one layout at given global numbers.

    All methods are collective.

    Args:
        vector: any vector of the layout.
        numbers: global numbers, different on all ranks if entries are put, shape (entries,).
    """

    def __init__(self, vector: PETSc.Vec, numbers: npt.ArrayLike) -> None:
        index_set = PETSc.IS().createGeneral(numbers, comm=PETSc.COMM_SELF)
        self._local = PETSc.Vec().createSeq(index_set.getLocalSize(), comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(vector, index_set, self._local, None)
        index_set.destroy()

    def get(self, vector: PETSc.Vec) -> FloatArray:
        """Return the entries of a vector."""
        self._scatter.scatter(vector, self._local, PETSc.InsertMode.INSERT)
        return self._local.array_r.copy()

    def put(self, values: FloatArray, vector: PETSc.Vec) -> None:
        """Set the entries of a vector."""
        self._reverse(values, vector, PETSc.InsertMode.INSERT)

    def add(self, values: FloatArray, vector: PETSc.Vec) -> None:
        """Add to the entries of a vector; equal numbers add up."""
        self._reverse(values, vector, PETSc.InsertMode.ADD)

    def _reverse(self, values: FloatArray, vector: PETSc.Vec, mode: PETSc.InsertMode) -> None:
        self._local.array[:] = values
        self._scatter.scatter(self._local, vector, mode, PETSc.ScatterMode.REVERSE)

    def destroy(self) -> None:
        """Free the communication plan."""
        self._scatter.destroy()
        self._local.destroy()
