"""Nodes of tied bodies whose motion along a direction a condition has taken already.

A tie makes the motions of a node unknowns relative to the body that it is tied to, but only those
that are left. Where the nodes of a surface move equally, one that is tied leads all others: the
surface follows the other body. That is all that there is to it if no second node is tied, or if the
other body moves equally along the same direction at all points that they face.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from castx.arrays import FloatArray, IntArray, LongArray
from castx.contact.kinematics.node_rows import NodeRows, owned_nodes
from castx.contact.kinematics.pair_rows import EqualMotion
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.mechanics.fixed_directions import PARALLEL
from castx.solvers.layout import Layout

MOVABLE, HELD = -2, -1
"""What conditions make of a motion; from 0 on the number of the surface that moves equally."""
SMALLEST_WEIGHT = 0.01
"""Of a corner of a facet, below which it has nothing to say at the point that a node faces."""


def at_tied_nodes(motion: EqualMotion, pairs: NodePairs) -> tuple[IntArray, IntArray]:
    """Return the indices of the tied nodes of a motion, and the numbers of their pairs."""
    found = np.intersect1d(motion.nodes, pairs.secondary_local, return_indices=True)
    return found[1].astype(np.int32), found[2].astype(np.int32)


def lead(
    motion: EqualMotion, pairs: NodePairs, name: str, layout: Layout
) -> tuple[IntArray, IntArray]:
    """Let a tied node lead a surface that moves equally; collective.

    Returns:
        Which nodes of the motion are tied on this rank, and the numbers of their pairs.

    Raises:
        CaseError: pairs of another interface lead it already.
    """
    at, numbers = at_tied_nodes(motion, pairs)
    counts = np.array(layout.comm.allgather(len(at)))
    if counts.any():
        if motion.tied_by is not None:
            raise CaseError(
                f"a uniform surface of {name!r} is tied to {motion.tied_by.primary!r} and to "
                f"{pairs.primary!r}: in one of both interfaces name the bodies the other way round"
            )
        here = layout.comm.rank == int(np.flatnonzero(counts)[0])
        motion.first = int(at[0]) if here else None
        motion.tied_by, motion.pair = pairs, int(numbers[0]) if here else 0
    return at, numbers


def motions_faced(
    pairs: NodePairs,
    numbers: IntArray,
    directions: FloatArray,
    b: int,
    layout: Layout,
    rows: NodeRows,
    equal: Sequence[EqualMotion],
) -> IntArray:
    """Return labels of the motions of the points that pairs face, by conditions; collective.

    Args:
        pairs: all pairs of an interface.
        numbers: of those of this rank that are asked for, shape (n,).
        directions: of the motions, shape (n, dimension).
        b: number of the primary body.
        layout: numbering of the displacements of all bodies.
        rows: of the primary body that conditions have taken.
        equal: surfaces that move equally.

    Returns:
        One number for each corner that counts, of the pairs of all ranks.
    """
    nodes, weights = (part[numbers] for part in pairs.partners)
    which, corner = np.nonzero(weights > SMALLEST_WEIGHT)
    asked = (nodes[which, corner], directions[which])
    everything = zip(*layout.comm.allgather(asked), strict=True)
    numbers_there, along = (np.concatenate(parts) for parts in everything)
    mine = _motions(numbers_there, along, b, layout, rows, equal)
    return np.concatenate(layout.comm.allgather(mine))


def _motions(
    nodes: LongArray,
    directions: FloatArray,
    b: int,
    layout: Layout,
    rows: NodeRows,
    equal: Sequence[EqualMotion],
) -> IntArray:
    local = layout.dofs(b, nodes) - layout.first - layout.local_slice(b).start
    local //= layout.block_sizes[b]
    here = np.flatnonzero((local >= 0) & (local < owned_nodes(layout, b)))
    own, along = local[here], directions[here]
    found = np.where(rows.can_add(own, along, PARALLEL), MOVABLE, HELD).astype(np.int32)
    for number, motion in enumerate(equal):
        if motion.body != b:
            continue
        slots = np.full(owned_nodes(layout, b), -1)
        slots[motion.nodes] = motion.slots
        in_it = slots[own] >= 0
        taken = rows.rows[own, np.maximum(slots[own], 0)]
        sine = np.linalg.norm(along - np.sum(along * taken, 1, keepdims=True) * taken, axis=1)
        found[in_it & (sine < PARALLEL)] = number
    return found
