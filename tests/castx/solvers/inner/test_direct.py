"""Factors against the dense algebra that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.inner.direct import DirectSolver
from tests.castx.solvers.inner.systems import PREFIX, applied


def test_a_direct_solver_solves(comm, dense):
    b = np.sin(np.arange(len(dense)))
    solver = DirectSolver(comm, PREFIX)
    for scale in (1.0, 3.0):
        found = applied(comm, solver, scale * dense, b)
        np.testing.assert_allclose(found, np.linalg.solve(scale * dense, b), rtol=1e-12)
    solver.destroy()


@pytest.mark.ranks
def test_factors_that_failed_leave_no_trace(comm, dense):
    """Of numbers that are none, as near a collapse."""
    b = np.sin(np.arange(len(dense)))
    solver = DirectSolver(comm, PREFIX)
    applied(comm, solver, dense, b)
    assert not np.isfinite(applied(comm, solver, np.nan * dense, b)).all()
    np.testing.assert_allclose(applied(comm, solver, dense, b), np.linalg.solve(dense, b))
    solver.destroy()
