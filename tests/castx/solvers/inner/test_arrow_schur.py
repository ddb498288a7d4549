"""Preconditioner of bodies and multipliers against dense saddle-point algebra."""

from __future__ import annotations

from contextlib import contextmanager

from petsc4py import PETSc

import numpy as np
import pytest

from castx.solvers.inner.arrow_schur import ArrowSchur
from castx.solvers.inner.nest import Block
from castx.solvers.inner.options import FACTORS
from tests.castx.solvers.distributed import gathered, index_set, matrix, options, vector

BODIES, PAIRS = 6, 2
"""Unknowns of both bodies, and pairs, of each rank."""
LOCAL = BODIES + PAIRS
PREFIX = "castx_test_schur_"


class Saddle:
    """Two bodies that closed pairs couple; the last pair of each rank is open.

    Each rank owns 4 unknowns of the first body, 2 of the second and its pairs.
    """

    def __init__(self, comm, weight):
        size, rng = LOCAL * comm.size, np.random.default_rng(5)
        place = np.tile(np.arange(LOCAL), comm.size)
        self.body = [place < 4, (place >= 4) & (place < BODIES)]
        self.pairs, opened = place >= BODIES, place == LOCAL - 1
        self.K = np.zeros((size, size))
        for own in self.body:
            root = rng.uniform(-1, 1, (own.sum(), own.sum()))
            self.K[np.ix_(own, own)] = root @ root.T + np.eye(own.sum())
        B = rng.uniform(-1, 1, (size, size))
        B[~(self.pairs & ~opened)] = 0.0
        B[:, self.pairs] = 0.0
        self.K += B + B.T
        self.K[opened, opened] = -3.0
        self.weights = np.where(opened, 1.0, weight * (1 + place % 3))
        self.schur = np.where(opened, -3.0, -self.weights)[self.pairs]
        self.constrained = opened


@contextmanager
def prepared(comm, saddle):
    """Yield the preconditioner, set up, and its matrix; solvers read options when they solve."""
    bodies = saddle.body[0] | saddle.body[1]
    blocks = [
        Block(index_set(comm, own[bodies]), np.zeros((0, own[bodies].sum())), FACTORS)
        for own in saddle.body
    ]
    own = slice(comm.rank * LOCAL, (comm.rank + 1) * LOCAL)
    weights = saddle.weights[own][BODIES:]
    made = ArrowSchur(comm, PREFIX, blocks, weights)
    A = matrix(comm, saddle.K, LOCAL)
    with options(PREFIX, made.defaults):
        made.set_up(A, saddle.constrained[own])
        yield made, A
    made.destroy()
    A.destroy()


def test_one_application_is_that_of_the_block_triangle(comm):
    """λ = S⁻¹ r_λ, then a sweep over the bodies with A + BᵀW⁻¹B for r_u + BᵀW⁻¹ r_λ - Bᵀ λ."""
    saddle = Saddle(comm, 0.5)
    u = ~saddle.pairs
    B = saddle.K[np.ix_(saddle.pairs, u)]
    scaled = B.T / saddle.weights[saddle.pairs]
    augmented = saddle.K[np.ix_(u, u)] + scaled @ B
    r = np.sin(1.0 + np.arange(len(saddle.K)))
    multipliers = r[saddle.pairs] / saddle.schur
    right = r[u] + scaled @ r[saddle.pairs] - B.T @ multipliers
    first, second = (own[u] for own in saddle.body)
    x = np.zeros(len(right))
    x[first] = np.linalg.solve(augmented[np.ix_(first, first)], right[first])
    rest = right[second] - augmented[np.ix_(second, first)] @ x[first]
    x[second] = np.linalg.solve(augmented[np.ix_(second, second)], rest)

    b = vector(comm, r)
    found = b.duplicate()
    with prepared(comm, saddle) as (made, _):
        made.solve(b, found)
    values = gathered(comm, found)
    np.testing.assert_allclose(values[saddle.pairs], multipliers, rtol=1e-12)
    np.testing.assert_allclose(values[u], x, rtol=1e-10, atol=1e-12)
    for item in (b, found):
        item.destroy()


class Shell:
    """Applies the preconditioner in a Krylov method."""

    def __init__(self, made):
        self.made = made

    def apply(self, pc, b, x):
        self.made.solve(b, x)


@pytest.mark.parametrize("weight", [1.0, 1e-2])
def test_a_krylov_method_finds_the_dense_solution(comm, weight):
    saddle = Saddle(comm, weight)
    expected = np.cos(np.arange(len(saddle.K)))
    b = vector(comm, saddle.K @ expected)
    x = b.duplicate()
    ksp = PETSc.KSP().create(comm)
    ksp.setType("fgmres")
    ksp.pc.setType("python")
    ksp.setTolerances(rtol=1e-11, max_it=50)
    with prepared(comm, saddle) as (made, A):
        ksp.setOperators(A)
        ksp.pc.setPythonContext(Shell(made))
        ksp.solve(b, x)
    assert ksp.getConvergedReason() > 0
    np.testing.assert_allclose(gathered(comm, x), expected, rtol=1e-8, atol=1e-9)
    for item in (ksp, b, x):
        item.destroy()
