"""Systems of two blocks, and what inner solvers make of them."""

from __future__ import annotations

import numpy as np

from castx.solvers.inner.nest import Block
from castx.solvers.inner.options import FACTORS
from tests.castx.solvers.distributed import gathered, index_set, matrix, options, vector

LOCAL = 8
PREFIX = "castx_test_inner_"


def in_second(comm):
    """Return which unknowns are in the second block: the last three of each rank."""
    return np.tile(np.arange(LOCAL) >= LOCAL - 3, comm.size)


def one_block(comm):
    """Return all unknowns as one block that is solved for exactly."""
    every = np.ones(LOCAL * comm.size, dtype=bool)
    return [Block(index_set(comm, every), np.zeros((0, LOCAL)), FACTORS)]


def two_blocks(comm, modes=None):
    """Return two blocks that are solved for exactly, with near-null vectors of both."""
    second, none = in_second(comm), np.zeros((0, LOCAL))
    given = [none, none] if modes is None else modes
    return [
        Block(index_set(comm, chosen), part, FACTORS)
        for chosen, part in zip((~second, second), given, strict=True)
    ]


def applied(comm, solver, dense, b, constrained=None):
    """Return what a solver makes of b for a dense matrix."""
    free = np.zeros(LOCAL, dtype=bool) if constrained is None else constrained
    A, right = matrix(comm, dense, LOCAL), vector(comm, b)
    x = right.duplicate()
    x.set(7.0)
    with options(PREFIX, solver.defaults):
        solver.set_up(A, free)
    solver.solve(right, x)
    found = gathered(comm, x)
    for item in (A, right, x):
        item.destroy()
    return found
