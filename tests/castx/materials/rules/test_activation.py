"""Thermal activation: Q/(R T_K), also at absolute zero."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.rules.activation import barrier

pytestmark = pytest.mark.serial


def test_the_barrier_at_temperatures() -> None:
    """At room temperature kT is 1/40 eV: 96.485 kJ/mol, 1 eV, there are 40 to 1 %."""
    assert barrier(np.array([96485.0]), np.array([17.0]))[0] == pytest.approx(40.0, rel=1e-2)
    found = barrier(np.array([1e5, 2e5]), np.array([126.85, 526.85]))
    np.testing.assert_allclose(found, 1e5 / (8.314462618 * 400.0), rtol=1e-9)


def test_without_energy_there_is_no_barrier_and_at_absolute_zero_no_flow() -> None:
    zero = np.array([-273.15, -300.0])
    np.testing.assert_array_equal(barrier(np.zeros(2), zero), 0.0)
    assert (barrier(np.full(2, 1e5), zero) > 1e300).all()
