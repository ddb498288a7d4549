"""Blocks of the preconditioner of the mechanics: each body is one, bodies that stick one together.

A sweep solves for one block after the other. The nodes of a tied body move with those that they
face, so that the block of the other one alone would be held by the inside of its neighbour: the
sweep would hand over a motion of both only bit by bit, in hundreds of iterations. So it is where
friction may hold them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from petsc4py import PETSc

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from castx.arrays import IntArray
from castx.contact.kinematics.transform import ConstraintTransform
from castx.mechanics.body import BodyMechanics
from castx.mechanics.rigid_modes import extent, near_null_modes
from castx.solvers.inner.nest import Block
from castx.solvers.layout import Layout

Group = Sequence[int]


def moving_together(bodies: int, ties: Iterable[tuple[int, int]]) -> list[list[int]]:
    """Return the bodies of each group that ties join, in the order of their first bodies.

    Args:
        bodies: how many there are.
        ties: pairs of numbers of bodies.
    """
    first, second = np.array([*ties], dtype=np.int64).reshape(-1, 2).T
    graph = coo_array((np.ones(len(first)), (first, second)), shape=(bodies, bodies))
    _, group = connected_components(graph, directed=False)
    found: dict[int, list[int]] = {}
    for body, label in enumerate(group):
        found.setdefault(int(label), []).append(body)
    return list(found.values())


def body_blocks(
    layout: Layout,
    parts: Sequence[BodyMechanics],
    groups: Sequence[Group],
    transform: ConstraintTransform,
    options: Sequence[Mapping[str, object]],
) -> list[Block]:
    """Return a block for each group of bodies, with their joint rigid motions.

    Args:
        layout: numbering of the unknowns.
        parts: the bodies.
        groups: numbers of bodies, those of a group with unknowns of one kind.
        transform: change of unknowns.
        options: of the solver of each group.
    """
    return [
        _block(layout, parts, group, transform, of_group)
        for group, of_group in zip(groups, options, strict=True)
    ]


def _block(
    layout: Layout,
    parts: Sequence[BodyMechanics],
    group: Group,
    transform: ConstraintTransform,
    options: Mapping[str, object],
) -> Block:
    box = extent([parts[b].unknowns for b in group])
    own = np.concatenate([np.arange(layout.size_local)[layout.local_slice(b)] for b in group])
    each = [near_null_modes(parts[b].unknowns, box) for b in group]
    modes = []
    for motions in zip(*each, strict=True):
        joint = np.zeros(layout.size_local)
        for b, motion in zip(group, motions, strict=True):
            joint[layout.local_slice(b)] = motion
        modes.append(transform.unknowns(joint)[own])
    return Block(_rows(layout, group, own), np.array(modes), options)


def _rows(layout: Layout, group: Group, own: IntArray) -> PETSc.IS:
    rows = PETSc.IS().createGeneral((own + layout.first).astype(np.int32), comm=layout.comm)
    rows.setBlockSize(layout.block_sizes[group[0]])
    return rows
