"""Diagonals of matrices, and by what factor they change."""

from __future__ import annotations

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray


def diagonal(matrix: PETSc.Mat) -> FloatArray:
    """Return the owned diagonal of a matrix."""
    vector = matrix.getDiagonal()
    values: FloatArray = vector.array_r.copy()
    vector.destroy()
    return values


def largest_factor(now: FloatArray, then: FloatArray, comm: MPI.Intracomm) -> float:
    """Return the largest factor by which a number has grown or shrunk, on any rank; at least 1.

    Args:
        now: present numbers.
        then: former ones, shape of `now`; zero and other signs are no factor but infinity.
        comm: ranks.
    """
    both = now * then > 0
    ratio = np.divide(now, then, out=np.ones_like(now), where=both)
    factor = np.where(both | (now == then), np.maximum(ratio, 1 / ratio), np.inf)
    return float(comm.allreduce(float(factor.max(initial=1.0)), op=MPI.MAX))
