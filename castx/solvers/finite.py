"""Refuses states with NaN or infinity."""

from __future__ import annotations

from collections.abc import Mapping

from mpi4py import MPI

import numpy as np
from dolfinx import fem

from castx.errors import ConvergenceError


def require_finite(comm: MPI.Intracomm, fields: Mapping[str, Mapping[str, fem.Function]]) -> None:
    """Check that nodal fields of bodies hold no NaN and no infinity; collective.

    Args:
        comm: ranks.
        fields: by the name of the field, then by the name of the body.

    Raises:
        ConvergenceError: names a field, its body and the place; on all ranks.
    """
    # NaN and infinity stay in a sum.
    sums = sum(float(f.x.array.sum()) for bodies in fields.values() for f in bodies.values())
    if comm.allreduce(bool(np.isfinite(sums)), MPI.LAND):
        return
    found = [
        _place(what, body, function)
        for what, bodies in fields.items()
        for body, function in bodies.items()
    ]
    texts = [text for own in comm.allgather(found) for text in own if text]
    if texts:
        raise ConvergenceError(texts[0])


def _place(what: str, body: str, function: fem.Function) -> str:
    """Return in words where a field is not finite on this rank; empty if it is."""
    space = function.function_space
    values = function.x.array.reshape(-1, space.dofmap.index_map_bs)
    wrong = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if not len(wrong):
        return ""
    point = space.tabulate_dof_coordinates()[wrong[0], : space.mesh.geometry.dim]
    place = ", ".join(f"{coordinate:.6g}" for coordinate in point)
    return f"the {what} of body {body!r} is not a finite number at ({place}) m"
