import numpy as np
import pytest

from castx.proof.verification.heat.chvorinov import (
    SAND,
    START,
    VERIFICATION,
    rough_time,
    sand_depth,
)
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_steps_and_depth():
    """π/4 (L/ΔT)²/(kρc) (V/A)², and sand of eight diffusion lengths in whole elements."""
    expected = np.pi / 4 * (9.5e8 / 640.0) ** 2 / (0.6 * 1.76e6) * 0.01**2
    assert rough_time(0.01) == pytest.approx(expected, rel=1e-12)
    depth = sand_depth(0.01, 1e-3)
    assert 0.0 <= depth - 8 * np.sqrt(0.6 / 1.76e6 * expected) < 1e-3
    assert START > 660.0 > SAND


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm)
