"""In-gates: surfaces by which a body is held while it has lost all contact (Chiumenti, section 4).

What is held stays where it was after the last accepted step, until the body touches again. Nodes
that face another body are left alone.
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, IntArray
from castx.contact.kinematics.coordinates import Coordinates
from castx.contact.kinematics.gaps import Gaps
from castx.errors import CaseError
from castx.mechanics.body import BodyMechanics

MOST_SWITCHES = 3
"""Times a gate may grip and let go in one solve."""


class InGate:
    """The in-gate surfaces of one body.

    Attributes:
        holds: whether the body hangs on them.

    Args:
        coordinates: in which the equilibrium is solved.
        gaps: the pairs of all interfaces.
        b: number of the body.
        body: the body.
        surfaces: names of the surfaces.
    """

    def __init__(
        self,
        coordinates: Coordinates,
        gaps: Gaps,
        b: int,
        body: BodyMechanics,
        surfaces: Sequence[str],
    ) -> None:
        self._comm = coordinates.layout.comm
        self.local = _free_rows(coordinates, b, body, surfaces)
        self._pairs = np.zeros(len(gaps.local), dtype=bool)
        for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
            self._pairs[part] = body.name in (interface.pairs.secondary, interface.pairs.primary)
        self._touches_always = bool(self._comm.allreduce(
            bool(np.any(gaps.tied & self._pairs)), op=MPI.LOR
        ))  # fmt: skip
        self.holds, self._switches = False, 0

    def begin(self, closed: BoolArray) -> None:
        """Begin a solve from a committed set of closed pairs."""
        self.holds, self._switches = not self._touches(closed), 0

    def _touches(self, closed: BoolArray) -> bool:
        here = bool(np.any(closed & self._pairs))
        return self._touches_always or bool(self._comm.allreduce(here, op=MPI.LOR))

    def update(self, closed: BoolArray, settled: bool) -> bool:
        """Grip a body that has no contact any more, let go of one that has; return whether it did.

        Args:
            closed: the present set of closed pairs.
            settled: whether the set does not change any more.
        """
        touches = self._touches(closed)
        wanted = not touches if settled or touches else self.holds
        if wanted == self.holds or self._switches >= MOST_SWITCHES:
            return False
        self.holds = wanted
        self._switches += 1
        return True


def _free_rows(
    coordinates: Coordinates, b: int, body: BodyMechanics, surfaces: Sequence[str]
) -> IntArray:
    """Return the owned coordinates of the nodes of surfaces that face no other body.

    Raises:
        CaseError: all of them do, or have prescribed displacements.
    """
    layout, owned = coordinates.layout, coordinates.owned_nodes(b)
    nodes = np.unique(np.concatenate([body.mesh.surface_nodes(name) for name in surfaces]))
    nodes = nodes[nodes < owned]
    start, size = layout.local_slice(b).start, layout.block_sizes[b]
    rows = start + nodes[:, None] * size + np.arange(coordinates.dimension)
    rows = rows[~coordinates.facing()[rows[:, 0]]]
    prescribed = [np.zeros(0, dtype=np.int32), *(item.local for item in coordinates.prescribed)]
    found = np.setdiff1d(rows.ravel(), np.concatenate(prescribed)).astype(np.int32)
    if layout.comm.allreduce(len(found), op=MPI.SUM) == 0:
        raise CaseError(
            f"support.in_gate of body {body.name!r}: all nodes of {', '.join(surfaces)} face "
            "another body or are prescribed; name a surface with free nodes"
        )
    return found
