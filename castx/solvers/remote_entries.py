"""Reads and writes entries of distributed vectors that other ranks own."""

from __future__ import annotations

from petsc4py import PETSc

import numpy.typing as npt

from castx.arrays import FloatArray


class RemoteEntries:
    """Gives a rank the entries at given global numbers in all vectors of one layout.

    All methods are collective.

    Args:
        vector: any vector of the layout.
        numbers: global numbers, shape (entries,); no rank may share one with another rank or name
            it twice where `put` is used.
    """

    def __init__(self, vector: PETSc.Vec, numbers: npt.ArrayLike) -> None:
        index_set = PETSc.IS().createGeneral(numbers, comm=PETSc.COMM_SELF)
        self._local = PETSc.Vec().createSeq(index_set.getLocalSize(), comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(vector, index_set, self._local, None)
        index_set.destroy()

    def get(self, vector: PETSc.Vec) -> FloatArray:
        """Return the entries of a vector, shape (entries,)."""
        self._scatter.scatter(vector, self._local, PETSc.InsertMode.INSERT)
        values: FloatArray = self._local.array_r.copy()
        return values

    def put(self, values: FloatArray, vector: PETSc.Vec) -> None:
        """Set the entries of a vector to values, shape (entries,)."""
        self._reverse(values, vector, PETSc.InsertMode.INSERT)

    def add(self, values: FloatArray, vector: PETSc.Vec) -> None:
        """Add values, shape (entries,), to the entries of a vector; equal numbers add up."""
        self._reverse(values, vector, PETSc.InsertMode.ADD)

    def _reverse(self, values: FloatArray, vector: PETSc.Vec, mode: PETSc.InsertMode) -> None:
        self._local.array[:] = values
        self._scatter.scatter(self._local, vector, mode, PETSc.ScatterMode.REVERSE)

    def destroy(self) -> None:
        """Free the communication plan."""
        self._scatter.destroy()
        self._local.destroy()
