"""PETSc's own duplicate of a communicator, kept from its first use on.

PETSc duplicates a communicator for the first object on it and frees the duplicate with the last
one. What Python's garbage collector lets go is destroyed only once all ranks have let it go; an
object that one rank destroys explicitly and another leaves to the collector outlives its twin. A
rank without any object would then duplicate anew, which is collective, while others take what they
have, and all of them wait for ever: at the latest when petsc4py clears up as Python exits.
"""

from __future__ import annotations

from mpi4py import MPI
from petsc4py import PETSc

_KEPT = MPI.Comm.Create_keyval()


def keep_duplicate(comm: MPI.Intracomm) -> None:
    """Keep PETSc's duplicate of a communicator for as long as PETSc runs; collective.

    Args:
        comm: on which PETSc's objects are made.
    """
    if comm.Get_attr(_KEPT):
        return
    holder = PETSc.IS().createStride(0, comm=comm)
    holder.incRef()  # never destroyed: the duplicate may go on no rank before any other
    comm.Set_attr(_KEPT, True)
