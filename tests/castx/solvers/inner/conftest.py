"""What the tests of inner solvers share."""

from __future__ import annotations

import numpy as np
import pytest

from tests.castx.solvers.inner.systems import LOCAL


@pytest.fixture
def dense(comm):
    """Return an unsymmetric matrix with a strong diagonal."""
    size = LOCAL * comm.size
    values = np.random.default_rng(7).uniform(-1, 1, (size, size))
    return values + 2 * size * np.eye(size)
