"""Says where the largest residual of a problem is, and where one is not a number."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray


class Part(NamedTuple):
    """A residual on this rank that has one name.

    Attributes:
        name: its subject, such as "body 'casting'".
        values: shape (places,) or (places, components).
        points: shape (places, dimension) [m].
    """

    name: str
    values: FloatArray
    points: FloatArray


def worst_place(comm: MPI.Intracomm, parts: Sequence[Part], unit: str) -> str:
    """Return the size and place of the largest residual in words, on all ranks; collective.

    Args:
        comm: ranks.
        parts: the whole residual.
        unit: of its values.
    """
    # NaN counts as the largest value.
    size, text = -1.0, ""
    for part in parts:
        if not len(part.points):  # numpy cannot divide nothing into rows
            continue
        values = np.abs(part.values.reshape(len(part.points), -1)).max(axis=1, initial=0.0)
        values = np.nan_to_num(values, nan=np.inf, posinf=np.inf)
        if values.max() > size:
            worst = int(values.argmax())
            size = float(values[worst])
            place = ", ".join(f"{coordinate:.6g}" for coordinate in part.points[worst])
            amount = f"largest residual {size:.3e} {unit}"
            if not np.isfinite(size):
                amount = "a residual is not a number"
            text = f"{amount} in {part.name} at ({place}) m"
    worst_of_all: tuple[float, str] = max(comm.allgather((size, text)))
    return worst_of_all[1]
