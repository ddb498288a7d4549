"""Motions along the surface, and derivatives of the return mapping against differences."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from petsc4py import PETSc

import numpy as np
import pytest
from scipy.linalg import block_diag

from castx.contact.friction.coulomb import SlidingRows
from castx.contact.friction.penalty_slip import PenaltySlip, force_derivatives, tangent_matrix
from tests.partitions import PARTITION, along_x
from tests.small_contact import dense, two_blocks


@pytest.mark.ranks
def test_motions_along_the_surface(comm, monkeypatch):
    """The upper block moves by (3, 5), the base by (1, -2): by 2 against each other along x."""
    monkeypatch.setattr(PARTITION, along_x)
    made = two_blocks(comm, "penalty", friction=0.3, solved=False)
    sliding = SlidingRows(made.gaps, [0.3])
    T = tangent_matrix(made.layout, list(made.bodies), made.gaps, sliding)
    u, moved = T.createVecs()
    values = u.array
    for b, motion in enumerate(((3.0, 5.0), (1.0, -2.0))):
        own = values[made.layout.local_slice(b)].reshape(-1, 3)
        own[:, :2] = motion
    T.mult(u, moved)
    np.testing.assert_allclose(moved.array_r, 2.0 * sliding.tangents[:, 0, 0], rtol=1e-12)


def forces(trial, normal, slips, coefficient, directions):
    """Return the forces along the surface: the trial ones, or μ f d where pairs slip."""
    size = np.linalg.norm(trial, axis=1, keepdims=True)
    d = np.where(np.sum(trial * directions, axis=1, keepdims=True) > 0, trial / size, directions)
    most = (coefficient * np.maximum(normal, 0.0))[:, None]
    return np.where(slips[:, None], most * d, trial)


@pytest.mark.ranks
def test_derivatives_against_differences(comm):
    """Pairs that stick, slip forwards, slip after turning back, and slip without pressure."""
    count, width, step = 4, 2, 1e-7
    generator = np.random.default_rng(3 + comm.rank)
    springs, coefficient = generator.uniform(1, 2, count), generator.uniform(0.2, 0.5, count)
    trial, gaps = generator.normal(size=(count, width)), -generator.uniform(1, 2, count)
    gaps[3] = 0.5
    directions = trial / np.linalg.norm(trial, axis=1, keepdims=True)
    directions[2] *= -1.0
    slips = np.array([False, True, True, True])
    imposed = PenaltySlip(
        np.ones(count, dtype=bool), springs, np.maximum(-springs * gaps, 0.0), trial
    )
    rows, gap_rows = (
        PETSc.Mat().createAIJ(((size, PETSc.DETERMINE), (5, PETSc.DETERMINE)), nnz=1, comm=comm)
        for size in (count * width, count)
    )
    for matrix in (rows, gap_rows):
        matrix.setUp()
    sliding: Any = SimpleNamespace(rows=np.arange(count), coefficient=coefficient)
    found = [
        dense(comm, matrix)
        for matrix in force_derivatives(rows, gap_rows, sliding, imposed, slips, directions)
    ]

    def at(moved, opened):
        return forces(
            trial + springs[:, None] * moved, -springs * (gaps + opened), slips, coefficient,
            directions,
        ).ravel()  # fmt: skip

    along = np.zeros((count * width, count * width))
    for j in range(count * width):
        moved = np.zeros(count * width)
        moved[j] = step
        moved = moved.reshape(count, width)
        along[:, j] = (at(moved, 0.0) - at(-moved, 0.0)) / (2 * step)
    across = np.zeros((count * width, count))
    for j in range(count):
        opened = np.zeros(count)
        opened[j] = step
        none = np.zeros((count, width))
        across[:, j] = (at(none, opened) - at(none, -opened)) / (2 * step)
    for matrix, own in zip(found, (along, across), strict=True):
        np.testing.assert_allclose(matrix, block_diag(*comm.allgather(own)), atol=1e-6)
