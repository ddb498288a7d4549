"""Compiled forms are kept for the whole test run: a test that builds a body has them at once.

DOLFINx looks for each form in its cache on disk, on several ranks one rank after the other. A run
builds thousands of small bodies from the same few hundred forms.
"""

from __future__ import annotations

from functools import wraps
from typing import Any

from mpi4py import MPI

import dolfinx.jit
import ufl


def keep() -> None:
    """Let DOLFINx take a form that was compiled before out of memory."""
    kept: dict[str, Any] = {}
    compiled = dolfinx.jit.ffcx_jit

    @wraps(compiled)
    def found(comm: MPI.Intracomm, ufl_object: Any, *options: Any, **more: Any) -> Any:
        if not isinstance(ufl_object, ufl.Form) or not _known_to_all(comm):
            return compiled(comm, ufl_object, *options, **more)
        key = f"{comm.size} {ufl_object.signature()} {options} {more}"
        if key not in kept:
            kept[key] = compiled(comm, ufl_object, *options, **more)
        return kept[key]

    dolfinx.jit.ffcx_jit = found


def _known_to_all(comm: MPI.Intracomm) -> bool:
    """Return whether a form is kept by all ranks of a communicator or by none of them."""
    same = (MPI.IDENT, MPI.CONGRUENT)
    return comm.size == 1 or MPI.Comm.Compare(comm, MPI.COMM_WORLD) in same
