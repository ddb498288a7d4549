"""Motions of pairs along the surface, and the derivatives of their friction by a penalty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from petsc4py import PETSc

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.contact.friction.coulomb import SlidingRows
from castx.contact.kinematics.gaps import Gaps, fill_directions, fill_midsides
from castx.solvers.layout import Layout


@dataclass(frozen=True)
class PenaltySlip:
    """Friction by a penalty as last imposed, of the rows with friction.

    Attributes:
        touching: rows whose pairs are closed, shape (n,).
        springs: ε S [N/m], shape (n,).
        normal: normal forces [N], shape (n,).
        trial: forces along the surface if all stuck [N], shape (n, dimension - 1).
    """

    touching: BoolArray
    springs: FloatArray
    normal: FloatArray
    trial: FloatArray


def tangent_matrix(
    layout: Layout, body_names: Sequence[str], gaps: Gaps, sliding: SlidingRows
) -> PETSc.Mat:
    """Return the motions along the surface over the displacements, row after row."""
    names = list(body_names)
    count, width = sliding.tangents.shape[:2]
    sizes = ((count * width, PETSc.DETERMINE), (layout.size_local, layout.size_global))
    T = PETSc.Mat().createAIJ(sizes, nnz=8, comm=layout.comm)
    T.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    first = T.getOwnershipRange()[0]
    for part, interface in zip(gaps.slices, gaps.interfaces, strict=True):
        mine = np.flatnonzero((sliding.rows >= part.start) & (sliding.rows < part.stop))
        pairs, index = interface.pairs, interface.index[sliding.rows[mine] - part.start]
        nodes, weights = pairs.partners
        own = (pairs.secondary, pairs.secondary_nodes[:, None], np.ones((len(nodes), 1)))
        for name, numbers, shares in (own, (pairs.primary, nodes, -weights)):
            for k in range(width if name in names else 0):
                rows = (first + mine * width + k).astype(np.int32)
                b, directions = names.index(name), sliding.tangents[mine, k]
                fill_directions(T, layout, b, rows, numbers[index], shares[index], directions)
        for k in range(width if len(mine) else 0):
            place = np.full(len(interface.local), -1, dtype=np.int32)
            place[sliding.rows[mine] - part.start] = first + mine * width + k
            motions = interface.midsides_along(interface.tangents[:, k])
            fill_midsides(T, layout, names, place, motions)
    T.assemble()
    return T


def force_derivatives(
    along_surface: PETSc.Mat,
    gap_rows: PETSc.Mat,
    sliding: SlidingRows,
    imposed: PenaltySlip,
    slips: BoolArray,
    directions: FloatArray,
) -> tuple[PETSc.Mat, PETSc.Mat]:
    """Return the derivatives of the forces over the motions and over the gaps.

    Where a pair slips, T = μ f d with d = T_trial/|T_trial| and f = -ε S g. The caller destroys
    both matrices.

    Args:
        along_surface: motions along the surface over the unknowns, for their numbering.
        gap_rows: gaps of all pairs over the displacements, for their numbering.
        sliding: the rows with friction.
        imposed: friction as last imposed.
        slips: rows that slip, shape (n,).
        directions: unit vectors d, shape (n, dimension - 1).
    """
    d = directions
    count, width = d.shape
    size = np.linalg.norm(imposed.trial, axis=1)
    stick = np.where(imposed.touching & ~slips, imposed.springs, 0.0)
    most = sliding.coefficient * imposed.normal
    follows = slips & (np.sum(imposed.trial * d, axis=1) > 0.0)
    turning = np.divide(most * imposed.springs, size, out=np.zeros(count), where=follows)
    blocks = stick[:, None, None] * np.eye(width)
    blocks += turning[:, None, None] * (np.eye(width) - d[:, :, None] * d[:, None, :])
    pressed = slips & (imposed.normal > 0)
    pressing = np.where(pressed, sliding.coefficient * imposed.springs, 0.0)
    columns = -pressing[:, None] * d
    own = along_surface.getOwnershipRange()[0] + np.arange(count * width).reshape(count, width)
    gaps = gap_rows.getOwnershipRange()[0] + sliding.rows
    along = _sparse(along_surface, along_surface, width)
    across = _sparse(along_surface, gap_rows, 1)
    for i in range(count):
        numbers = own[i].astype(np.int32)
        along.setValues(numbers, numbers, blocks[i])
        across.setValues(numbers, np.int32(gaps[i]), columns[i])
    along.assemble()
    across.assemble()
    return along, across


def _sparse(rows: PETSc.Mat, columns: PETSc.Mat, width: int) -> PETSc.Mat:
    """Return an empty matrix between the rows of two matrices."""
    sizes = (rows.getSizes()[0], columns.getSizes()[0])
    return PETSc.Mat().createAIJ(sizes, nnz=width, comm=rows.getComm())
