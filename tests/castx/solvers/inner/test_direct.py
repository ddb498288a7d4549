"""Factors against the dense algebra that they stand for."""

from __future__ import annotations

import numpy as np

from castx.solvers.inner.direct import DirectSolver
from tests.castx.solvers.inner.systems import PREFIX, applied


def test_a_direct_solver_solves(comm, dense):
    b = np.sin(np.arange(len(dense)))
    solver = DirectSolver(comm, PREFIX)
    for scale in (1.0, 3.0):
        found = applied(comm, solver, scale * dense, b)
        np.testing.assert_allclose(found, np.linalg.solve(scale * dense, b), rtol=1e-12)
    solver.destroy()
