"""Two small blocks in contact, and dense matrices of all ranks, for tests of single modules."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.arrays import FloatArray
from castx.contact.choice import Contact
from castx.equilibrium.problem import MechanicalProblem
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem, pulled, pushed

SOFT, STIFF = (7e9, 0.33), (70e9, 0.3)


def two_blocks(
    comm: MPI.Intracomm, method: str = "condensed", solved: bool = True, **contact: Any
) -> MechanicalProblem:
    """Return a block pushed over on its base, so that some pairs open."""
    bodies = {
        "upper": body(elastic(*SOFT), loads=(pushed("top", 1e6), pulled("side", 2e5, 0.0))),
        "base": body(elastic(*STIFF)),
    }
    held = {"base": [fixed("bottom", "all")], "upper": [fixed("top", "x")]}
    mesh = blocks(comm, symmetry=False, size=0.01)
    made = problem(mesh, bodies, held, [Contact("upper", "base", method, **contact)])
    if solved:
        made.equilibrium.solve(0.0)
    return made


def dense(comm: MPI.Intracomm, matrix: PETSc.Mat) -> FloatArray:
    """Return all rows of a matrix on all ranks."""
    converted = matrix.convert("dense", PETSc.Mat())
    rows = np.vstack(comm.allgather(converted.getDenseArray().copy()))
    converted.destroy()
    return rows


def waves(vector: PETSc.Vec, frequency: float = 0.7) -> FloatArray:
    """Return owned values that depend on the global number alone."""
    return np.sin(1.0 + frequency * np.arange(*vector.getOwnershipRange()))


def of_all(comm: MPI.Intracomm, vector: PETSc.Vec) -> FloatArray:
    """Return the entries of a vector of all ranks."""
    return everywhere(comm, vector.array_r.copy())
