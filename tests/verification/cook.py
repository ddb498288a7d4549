"""Pressures inside Cook's membrane, of `castx/proof/verification/solids/cook.py`."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.equilibrium.problem import MechanicalProblem
from tests.elastic_bodies import everywhere, motion, places


def inner_pressures(comm: MPI.Intracomm, made: MechanicalProblem, n: int) -> FloatArray:
    """Return p at the nodes of the grid from the fourth line behind each edge, on all ranks."""
    x, y = everywhere(comm, places(made, "membrane")).T
    column = np.round(x / 48 * n).astype(int)
    bottom, top = 44 * x / 48, 44 + 16 * x / 48
    row = np.round((y - bottom) / (top - bottom) * n).astype(int)
    p: FloatArray = np.full((n + 1, n + 1), np.nan)
    p[column, row] = everywhere(comm, motion(made, "membrane"))[:, 2]
    return p[4:-4, 4:-4]
