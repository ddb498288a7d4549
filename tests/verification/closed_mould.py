"""What V17 demands of a run, as `castx/proof/verification/contact/closed_mould.py` has it."""

from __future__ import annotations

import numpy as np
import pytest

from castx.process.state import State
from castx.proof.verification.contact.closed_mould import HEIGHT, SHRINKAGE, WEIGHT, WIDTH, by_side


def check(state: State, tolerance: float = 1e-6) -> None:
    """Compare the last state with the exact answer."""
    gaps = by_side(state, "gap")
    pressures = by_side(state, "contact_pressure")
    assert state.totals["casting/mould.force.y"] == pytest.approx(WEIGHT, rel=tolerance)
    assert state.totals["casting/mould.force.x"] == pytest.approx(0.0, abs=1e-9 * WEIGHT)
    for side in ("lid", "left", "right"):
        assert not pressures[side].any()
    np.testing.assert_allclose(gaps["lid"], SHRINKAGE * HEIGHT, rtol=1e-4)
    left, right = gaps["left"], gaps["right"]
    np.testing.assert_allclose(left, right.mean(), rtol=1e-3)
    assert left.mean() + right.mean() == pytest.approx(SHRINKAGE * WIDTH, rel=1e-4)
    assert state.totals["support_force"] < 1e-4 * WEIGHT
