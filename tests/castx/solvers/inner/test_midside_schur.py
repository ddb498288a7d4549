"""Preconditioner of nodes and mid-sides against dense algebra, with mid-sides that are apart."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.inner.midside_schur import MidsideSchur
from castx.solvers.inner.nest import Block
from castx.solvers.inner.options import FACTORS
from tests.castx.solvers.distributed import gathered, index_set, matrix, options, vector

NODES, MIDSIDES = 4, 3
"""Unknowns of the nodes and of the mid-sides of each rank; every other one is a pressure."""
LOCAL = NODES + MIDSIDES
PREFIX = "castx_test_midsides_"


@pytest.mark.ranks
def test_one_application_condenses_the_mid_sides(comm):
    """u_m = D⁻¹ r_m, S u_n = r_n − B u_m, and again u_m = D⁻¹ (r_m − Bᵀ u_n)."""
    size, rng = LOCAL * comm.size, np.random.default_rng(3)
    place = np.tile(np.arange(LOCAL), comm.size)
    n, m = place < NODES, place >= NODES
    K = np.zeros((size, size))
    root = rng.uniform(-1, 1, (n.sum(), n.sum()))
    K[np.ix_(n, n)] = root @ root.T + 9 * np.eye(n.sum())
    K[np.ix_(n, m)] = rng.uniform(-1, 1, (n.sum(), m.sum()))
    K[np.ix_(m, n)] = K[np.ix_(n, m)].T
    K[m, m] = 4.0 + place[m]
    B, D = K[np.ix_(n, m)], K[m, m]
    pressures = place[n] % 2 == 1
    weight = np.where(np.outer(pressures, pressures), 4.0, 0.5)
    S = K[np.ix_(n, n)] - weight * (B / D @ B.T)
    r = np.sin(1.0 + np.arange(size))
    x = np.linalg.solve(S, r[n] - B @ (r[m] / D))

    own = slice(comm.rank * NODES, (comm.rank + 1) * NODES)
    block = Block(index_set(comm, n), np.zeros((0, NODES)), FACTORS)
    made = MidsideSchur(comm, PREFIX, [block], pressures[own], comm.rank * LOCAL)
    A, b = matrix(comm, K, LOCAL), vector(comm, r)
    found = b.duplicate()
    with options(PREFIX, made.defaults):
        for _ in range(2):  # and anew
            made.set_up(A, np.zeros(LOCAL, dtype=bool))
            made.solve(b, found)
    values = gathered(comm, found)
    np.testing.assert_allclose(values[n], x, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(values[m], (r[m] - B.T @ x) / D, rtol=1e-9, atol=1e-12)
    for item in (made, A, b, found):
        item.destroy()
