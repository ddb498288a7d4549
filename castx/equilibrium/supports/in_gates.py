"""In-gates: surfaces by which a body is held while it has lost all contact (Chiumenti, section 4).

Their nodes stay where they were after the last accepted step, until the body touches again. Nodes
that face another body are left alone.
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, IntArray
from castx.contact.kinematics.gaps import Gaps
from castx.contact.kinematics.node_rows import owned_nodes
from castx.contact.kinematics.transform import ConstraintTransform
from castx.errors import CaseError
from castx.mechanics.body import BodyMechanics

MOST_SWITCHES = 3
"""Times a gate may grip and let go in one solve."""


class InGate:
    """The in-gate surfaces of one body.

    Attributes:
        acts: whether the body hangs on them.

    Args:
        transform: change of unknowns of all bodies.
        gaps: the pairs of all interfaces.
        b: number of the body.
        body: the body.
        surfaces: names of the surfaces.
    """

    def __init__(
        self,
        transform: ConstraintTransform,
        gaps: Gaps,
        b: int,
        body: BodyMechanics,
        surfaces: Sequence[str],
    ) -> None:
        self._comm = transform.layout.comm
        self.local = _free_rows(transform, b, body, surfaces)
        self._pairs = np.zeros(len(gaps.local), dtype=bool)
        for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
            self._pairs[part] = body.name in (interface.pairs.secondary, interface.pairs.primary)
        self._touches_always = bool(self._comm.allreduce(
            bool(np.any(gaps.tied & self._pairs)), op=MPI.LOR
        ))  # fmt: skip
        self.acts, self._switches = False, 0

    def begin(self, closed: BoolArray) -> None:
        """Begin a solve from a committed set of closed pairs."""
        self.acts, self._switches = not self._touches(closed), 0

    def _touches(self, closed: BoolArray) -> bool:
        here = bool(np.any(closed & self._pairs))
        return self._touches_always or bool(self._comm.allreduce(here, op=MPI.LOR))

    def update(self, closed: BoolArray, settled: bool) -> bool:
        """Grip a body without contact, release one with contact; return whether any changed.

        Args:
            closed: the present set of closed pairs.
            settled: whether the set does not change any more.
        """
        touches = self._touches(closed)
        wanted = not touches if settled or touches else self.acts
        if wanted == self.acts or self._switches >= MOST_SWITCHES:
            return False
        self.acts = wanted
        self._switches += 1
        return True


def _free_rows(
    transform: ConstraintTransform, b: int, body: BodyMechanics, surfaces: Sequence[str]
) -> IntArray:
    """Return the owned unknowns of the nodes of surfaces that face no other body.

    Raises:
        CaseError: all of them do, or have prescribed displacements.
    """
    layout = transform.layout
    owned = owned_nodes(layout, b)
    nodes = np.unique(np.concatenate([body.mesh.surface_nodes(name) for name in surfaces]))
    nodes = nodes[nodes < owned]
    start, size = layout.local_slice(b).start, layout.block_sizes[b]
    rows = start + nodes[:, None] * size + np.arange(transform.dimension)
    rows = rows[~transform.facing()[rows[:, 0]]]
    prescribed = [np.zeros(0, dtype=np.int32), *(item.local for item in transform.prescribed)]
    found = np.setdiff1d(rows.ravel(), np.concatenate(prescribed)).astype(np.int32)
    if layout.comm.allreduce(len(found), op=MPI.SUM) == 0:
        raise CaseError(
            f"support.in_gate of body {body.name!r}: all nodes of {', '.join(surfaces)} face "
            "another body or are prescribed; name a surface with free nodes"
        )
    return found
