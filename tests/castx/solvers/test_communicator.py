"""PETSc's duplicate of a communicator lives on all ranks or on none."""

from __future__ import annotations

import ctypes

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np

from castx.solvers.communicator import keep_duplicate
from castx.solvers.layout import Layout


def has_duplicate(comm: MPI.Intracomm) -> list[bool]:
    """Return for all ranks whether PETSc has a duplicate of their communicator."""
    keyval = ctypes.c_int.in_dll(ctypes.CDLL(PETSc.__file__), "Petsc_InnerComm_keyval")
    return comm.allgather(comm.Get_attr(keyval.value) is not None)


def leave_behind(comm: MPI.Intracomm) -> None:
    """Destroy a vector on the last rank and leave its twins to the garbage of PETSc."""
    vector = PETSc.Vec().createMPI((2, PETSc.DECIDE), comm=comm)
    if comm.rank == comm.size - 1:
        vector.destroy()
    del vector


def test_a_duplicate_that_is_kept_outlives_what_only_some_ranks_destroy(comm):
    kept = comm.Dup()
    keep_duplicate(kept)
    leave_behind(kept)
    assert all(has_duplicate(kept))
    PETSc.garbage_cleanup(kept)  # without the duplicate of all ranks it would never end
    assert all(has_duplicate(kept))
    norm = PETSc.Vec().createMPI((2, PETSc.DECIDE), comm=kept)
    norm.set(1.0)
    assert norm.norm(PETSc.NormType.NORM_1) == 2 * comm.size
    norm.destroy()


def test_without_it_ranks_differ(comm):
    """What the module is for: on this communicator a collective call of PETSc would hang."""
    own = comm.Dup()
    leave_behind(own)
    assert has_duplicate(own) == [True] * (comm.size - 1) + [False]


def test_every_numbering_keeps_it(comm):
    own = comm.Dup()
    layout = Layout(own, [], [])
    assert layout.size_global == 0
    leave_behind(own)
    np.testing.assert_array_equal(has_duplicate(own), True)
