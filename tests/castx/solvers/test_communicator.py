"""PETSc's duplicate of a communicator lives on all ranks or on none."""

from __future__ import annotations

from collections.abc import Callable

from mpi4py import MPI
from petsc4py import PETSc

import numpy as np
import pytest

from castx.solvers.communicator import keep_duplicate
from castx.solvers.layout import Layout


def duplicates(comm: MPI.Intracomm) -> Callable[[], list[bool]]:
    """Return a function that says for all ranks whether PETSc has a duplicate of a communicator.

    MPI copies an attribute to each duplicate, and deletes it with that.
    """
    living = [0]

    def copied(_: MPI.Comm, __: int, value: bool) -> bool:
        living[0] += 1
        return value

    def deleted(*_: object) -> None:
        living[0] -= 1

    comm.Set_attr(MPI.Comm.Create_keyval(copied, deleted), True)
    return lambda: comm.allgather(living[0] > 0)


def leave_behind(comm: MPI.Intracomm) -> None:
    """Destroy a vector on the last rank and leave its twins to the garbage of PETSc."""
    vector = PETSc.Vec().createMPI((2, PETSc.DECIDE), comm=comm)
    if comm.rank == comm.size - 1:
        vector.destroy()
    del vector


@pytest.mark.ranks
def test_a_duplicate_that_is_kept_outlives_what_only_some_ranks_destroy(comm):
    kept = comm.Dup()
    have = duplicates(kept)
    keep_duplicate(kept)
    leave_behind(kept)
    assert all(have())
    PETSc.garbage_cleanup(kept)  # without the duplicate of all ranks it would never end
    assert all(have())
    norm = PETSc.Vec().createMPI((2, PETSc.DECIDE), comm=kept)
    norm.set(1.0)
    assert norm.norm(PETSc.NormType.NORM_1) == 2 * comm.size
    norm.destroy()


@pytest.mark.ranks
def test_without_it_ranks_differ(comm):
    """What the module is for: on this communicator a collective call of PETSc would hang."""
    own = comm.Dup()
    have = duplicates(own)
    leave_behind(own)
    assert have() == [True] * (comm.size - 1) + [False]


def test_every_numbering_keeps_it(comm):
    own = comm.Dup()
    have = duplicates(own)
    layout = Layout(own, [], [])
    assert layout.size_global == 0
    leave_behind(own)
    np.testing.assert_array_equal(have(), True)
