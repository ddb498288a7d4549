"""Diagonals of matrices, by what factor they change, and whether a matrix is symmetric."""

from __future__ import annotations

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray

ASYMMETRY = 1e-8
"""Part of the product of a matrix, scaled to a diagonal of one, by which that of its transpose may
be another one; rounding makes some 1e-15 of it."""


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


def is_symmetric(matrix: PETSc.Mat) -> bool:
    """Return whether a matrix is its own transpose, by one product of each; collective."""
    left, right = matrix.createVecs()
    found, of_transpose = right.duplicate(), left.duplicate()
    size = np.abs(diagonal(matrix))
    scale = 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))
    drawn = np.random.default_rng(matrix.getOwnershipRange()[0]).standard_normal(len(scale))
    right.array[:] = scale * drawn
    matrix.mult(right, found)
    matrix.multTranspose(right, of_transpose)
    of_transpose.array[:] = scale * (of_transpose.array_r - found.array_r)
    found.array[:] = scale * found.array_r
    same = of_transpose.norm() <= ASYMMETRY * found.norm()
    for vector in (left, right, found, of_transpose):
        vector.destroy()
    return bool(same)
