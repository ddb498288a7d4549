"""Dense numpy matrices and vectors as PETSc's of all ranks, and back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray


def matrix(comm: MPI.Intracomm, dense: FloatArray, local: int) -> PETSc.Mat:
    """Return a matrix of which each rank owns as many rows and columns."""
    size = local * comm.size
    made = PETSc.Mat().createAIJ(((local, size), (local, size)), nnz=size, comm=comm)
    own = np.arange(*made.getOwnershipRange(), dtype=np.int32)
    made.setValues(own, np.arange(size, dtype=np.int32), dense[own])
    made.assemble()
    return made


def vector(comm: MPI.Intracomm, values: FloatArray) -> PETSc.Vec:
    """Return a vector of which each rank owns an equal part."""
    made = PETSc.Vec().createMPI((len(values) // comm.size, len(values)), comm=comm)
    made.array[:] = values[slice(*made.getOwnershipRange())]
    return made


def gathered(comm: MPI.Intracomm, made: PETSc.Vec) -> FloatArray:
    """Return the entries of all ranks."""
    return np.concatenate(comm.allgather(made.array_r))


def index_set(comm: MPI.Intracomm, chosen: FloatArray) -> PETSc.IS:
    """Return the numbers of the chosen entries, each rank those of its equal part."""
    local = len(chosen) // comm.size
    own = np.flatnonzero(chosen[comm.rank * local : (comm.rank + 1) * local])
    return PETSc.IS().createGeneral((own + comm.rank * local).astype(np.int32), comm=comm)


@contextmanager
def options(prefix: str, values: Mapping[str, object]) -> Iterator[None]:
    """Keep PETSc options in the database for a while."""
    database = PETSc.Options(prefix)
    for key, value in values.items():
        text = str(value).lower() if isinstance(value, bool) else str(value)
        database.setValue(key, text)
    try:
        yield
    finally:
        for key in values:
            database.delValue(key)
