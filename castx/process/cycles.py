"""Change of the temperatures from cycle to cycle, and distance from the periodic state."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from mpi4py import MPI

import numpy as np
from dolfinx import fem

from castx.arrays import FloatArray
from castx.domain.mesh import CastingMesh
from castx.stateful import Arrays, Saved


class CycleEnds:
    """Temperatures of bodies at the end of a cycle, or when they were removed.

    Args:
        mesh: of all bodies.
        kept: names of the bodies that are not renewed.
    """

    def __init__(self, mesh: CastingMesh, kept: Collection[str]) -> None:
        self._comm = mesh.comm
        self._numberings = {name: mesh.bodies[name].node_numbering for name in kept}
        self._now: dict[str, FloatArray] = {
            name: np.full(numbering.owned, np.nan) for name, numbering in self._numberings.items()
        }
        self._last = dict(self._now)

    def note(self, temperature: Mapping[str, fem.Function]) -> None:
        """Note the temperatures of the bodies that are there at the end of a stage [°C]."""
        for name, numbering in self._numberings.items():
            if name in temperature:
                self._now[name] = temperature[name].x.array[: numbering.owned].copy()

    def change(self) -> float | None:
        """Return the largest change of a node from cycle to cycle [K]; collective.

        To be called once at the end of a cycle; None at the end of the first one.
        """
        largest = -np.inf
        for name, now in self._now.items():
            differences = np.abs(now - self._last[name])
            if not np.isnan(differences).any():
                largest = max(largest, float(differences.max(initial=-np.inf)))
        self._last = dict(self._now)
        largest = float(self._comm.allreduce(largest, op=MPI.MAX))
        return largest if np.isfinite(largest) else None

    def saved(self) -> dict[str, Saved]:
        """Return the temperatures [°C]."""
        kinds = {"now": self._now, "last": self._last}
        return {
            f"{body}/{kind}": Saved(known[body], numbering)
            for kind, known in kinds.items()
            for body, numbering in self._numberings.items()
        }

    def restore(self, arrays: Arrays) -> None:
        """Restore the temperatures [°C]."""
        for body, numbering in self._numberings.items():
            self._now[body] = arrays[f"{body}/now"][: numbering.owned].copy()
            self._last[body] = arrays[f"{body}/last"][: numbering.owned].copy()


def distance_from_periodic(changes: Sequence[float | None]) -> float | None:
    """Return the distance of the last cycle from the periodic state [K], None if unknown.

    Changes that shrink by the factor q from cycle to cycle still add up to q/(1 − q) times the last
    one.

    Args:
        changes: from each cycle to the next one [K], None where there was none.
    """
    known = [change for change in changes[-2:] if change is not None]
    if len(known) < 2 or known[1] >= known[0]:
        return 0.0 if known and known[-1] == 0.0 else None
    ratio = known[1] / known[0]
    return known[1] * ratio / (1.0 - ratio)
