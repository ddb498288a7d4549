"""Principal stresses, indices of cracks and the three-bar frame."""

import numpy as np
import pytest

from castx.foundry.cracking import (
    brittle_strain_ratio,
    cold_crack_index,
    principal_values,
    three_bar_stresses,
)

pytestmark = pytest.mark.serial


def test_principal_values_of_a_rotated_tensor():
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    tensor = turn @ np.diag([5e6, -2e6, 1e6]) @ turn.T
    rows = tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(principal_values(rows[None]), [[5e6, 1e6, -2e6]], rtol=1e-12)


def test_the_frame_of_three_bars():
    thick, thin = three_bar_stresses(70e9, 24e-6, 120.0, 2e-4, 4e-4)
    assert thick == pytest.approx(67.2e6, rel=1e-12)
    assert thin == pytest.approx(-134.4e6, rel=1e-12)


def test_a_frame_of_other_bars_balances_and_fits():
    """No force on the whole, and equal lengths: (σ_2 - σ_1)/E = α ΔT."""
    thick, thin = three_bar_stresses(105e9, 11e-6, 85.0, 3e-4, 2.5e-4)
    assert thick * 2.5e-4 + thin * 3e-4 == pytest.approx(0.0, abs=1e-6)
    assert (thick - thin) / 105e9 == pytest.approx(11e-6 * 85.0, rel=1e-12)


def test_the_crack_index_is_the_worst_moment_of_the_cooling():
    stress = np.array([[10e6, -5e6], [30e6, -20e6], [60e6, -1e6]])
    strength = np.array([[20e6, 20e6], [50e6, 50e6], [200e6, 200e6]])
    np.testing.assert_allclose(cold_crack_index(stress, strength), [0.6, 0.0], rtol=1e-14)


def test_strain_in_the_brittle_range():
    gained = np.array([1e-3 * 4.0, -1e-3])
    np.testing.assert_allclose(brittle_strain_ratio(gained, 0.02), [0.2, 0.0], rtol=1e-14)
