"""V20 without ends: a slice of the cylinder against a one-dimensional solution of its own.

The demands are those of V20 at h = R/40 and Δt ≤ 0.1 s: 2.5 K (5 K for t < 2 s), and for the gap
3 % or 1 µm, whichever is larger.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.proof.verification.coupled.cylinder import CLOSED, GAS, reference, row, slice_case
from tests.coupled_cases import states


@pytest.mark.slow
@pytest.mark.serial
def test_slice_follows_the_radial_solution(comm) -> None:
    rows = [row(state) for state in states(comm, slice_case()) if state.step > 0]
    time, centre, surface, mould, gap, _ = np.transpose(rows)
    exact = reference(400, 0.005, time)
    for name, found in (("centre", centre), ("surface", surface), ("mould", mould)):
        error = np.abs(found - exact[name])
        assert error[time >= 2.0].max() < 2.5, name
        assert error.max() < 5.0, name
    assert (np.abs(gap - exact["gap"]) < np.maximum(0.03 * exact["gap"], 1e-6)).all()
    assert gap[-1] > 1.5 * GAS / CLOSED, "the gap throttles the heat"
