"""When the pairs of an interface opened first: their gaps grew beyond a threshold.

Within a step gaps are linear. A pair that is open from the start opens then; a new body begins
again.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Protocol

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.domain.measures import nodal_sum
from castx.stateful import Arrays, Saved, number, part_of, saved_parts

if TYPE_CHECKING:
    from castx.domain.mesh import CastingMesh
    from castx.domain.pairs.node_pairs import NodePairs

FIRST_OPENING = "first_opening"
"""Name of the field."""


class PairedState(Protocol):
    """The part of a state after an accepted step that is needed here."""

    @property
    def time(self) -> float:
        """End of the step [s]."""

    @property
    def process(self) -> Any:
        """Stage and cycle, and bodies that are new."""

    @property
    def pairs(self) -> Mapping[str, NodePairs]:
        """The interfaces that are there."""

    def paired(self, interface: str, name: str, /) -> FloatArray:
        """Return a field of the owned pairs."""


class FirstOpening:
    """First openings of the pairs of one interface.

    Attributes:
        times: of the owned pairs, not a number before, (pairs,) [s].

    Args:
        pairs: of the interface.
        comm: the ranks.
        threshold: gap beyond which a pair is open [m].
    """

    def __init__(self, pairs: NodePairs, comm: MPI.Intracomm, threshold: float) -> None:
        self._pairs, self._comm, self._threshold = pairs, comm, threshold
        self.begin()

    def begin(self) -> None:
        """Forget the openings so far."""
        self.times: FloatArray = np.full(len(self._pairs.areas), np.nan)
        self._gap: FloatArray = np.full(len(self._pairs.areas), -np.inf)
        self._time = np.nan

    def update(self, time: float, gap: FloatArray) -> None:
        """Take over the gaps at the end of a step.

        Args:
            time: there [s].
            gap: of the owned pairs, (pairs,) [m].
        """
        opened = np.isnan(self.times) & (gap > self._threshold)
        start = self._time if np.isfinite(self._time) else time
        before = np.where(np.isfinite(self._gap), self._gap, gap)[opened]
        growth = gap[opened] - before
        share = np.divide(
            self._threshold - before, growth, out=np.ones_like(growth), where=growth > 0.0
        )
        self.times[opened] = start + np.clip(share, 0.0, 1.0) * (time - start)
        self._gap, self._time = gap.copy(), time

    def described(self) -> dict[str, float | None]:
        """Return the first time of all pairs [s] and the share of the area that has been open."""
        opened, areas = np.isfinite(self.times), self._pairs.areas
        first = self._comm.allreduce(float(self.times[opened].min(initial=np.inf)), MPI.MIN)
        sums = self._comm.allreduce(np.array([areas @ opened, areas.sum()]), MPI.SUM)
        share = min(float(sums[0] / sums[1]), 1.0) if sums[1] > 0.0 else 0.0
        return {"first": first if np.isfinite(first) else None, "opened_fraction": share}

    def saved(self) -> dict[str, Saved]:
        """Return the times and the gaps after the last step."""
        numbering = self._pairs.numbering
        pairs = {"times": Saved(self.times, numbering), "gap": Saved(self._gap, numbering)}
        return pairs | {"time": number(self._time)}

    def restore(self, arrays: Arrays) -> None:
        """Go on with the openings of an earlier part of the run."""
        self.times, self._gap = arrays["times"].copy(), arrays["gap"].copy()
        self._time = float(arrays["time"])


class FirstOpenings:
    """First openings of all interfaces.

    Args:
        mesh: of all bodies.
        pairs: of the interfaces, by name.
        threshold: gap beyond which a pair is open [m].
    """

    def __init__(self, mesh: CastingMesh, pairs: Mapping[str, NodePairs], threshold: float) -> None:
        self._mesh, self._pairs = mesh, pairs
        self._found = {name: FirstOpening(of, mesh.comm, threshold) for name, of in pairs.items()}

    def update(self, state: PairedState) -> None:
        """Take over the state after an accepted step."""
        for name, found in self._found.items():
            if state.process.renewed & {self._pairs[name].secondary, self._pairs[name].primary}:
                found.begin()
            if name in state.pairs:
                found.update(state.time, state.paired(name, "gap"))

    def field(self, body: str, name: str) -> FloatArray | None:
        """Return when the nodes of a body first left another one, (nodes,) [s]; collective.

        Not a number off the interfaces of which it is the secondary body, and where it has not
        happened; the earliest time where several pairs are at a node. None: nothing is known.
        """
        if name != FIRST_OPENING:
            return None
        mesh = self._mesh.bodies[body]
        times: FloatArray = np.full(len(mesh.parent_vertices), np.inf)
        for interface, found in self._found.items():
            pairs = self._pairs[interface]
            if pairs.secondary == body:
                opened = np.where(np.isfinite(found.times), found.times, np.inf)
                np.minimum.at(times, pairs.secondary_local, opened)
        known = np.isfinite(times)
        everywhere = nodal_sum(mesh, np.where(known, times, 0.0))
        return np.where(nodal_sum(mesh, known.astype(np.float64)) > 0.0, everywhere, np.nan)

    def totals(self) -> dict[str, float]:
        """Return nothing: gaps are in history.csv anyway."""
        return {}

    def described(self) -> dict[str, Any]:
        """Return first times and areas by interface for run.json; collective."""
        return {name: found.described() for name, found in self._found.items()}

    def saved(self) -> dict[str, Saved]:
        """Return the openings of all interfaces; collective."""
        return saved_parts(self._found)

    def restore(self, arrays: Arrays) -> None:
        """Go on with the openings of an earlier part; others begin now."""
        for name, found in self._found.items():
            if part := part_of(arrays, name):
                found.restore(part)


def first_openings_of(
    case: Case, mesh: CastingMesh, pairs: Mapping[str, NodePairs]
) -> FirstOpenings:
    """Return the first openings of a case; without mechanics nothing opens."""
    followed = {} if case.coupling.scheme == "thermal" else pairs
    return FirstOpenings(mesh, followed, case.foundry.opening_gap)
