"""X2 and X3: two-way within each step, where the other program lags by one."""

import pytest

from castx.proof.foreign.cases.pressed_conductance import (
    ALUMINIUM,
    HARMONIC,
    STEEL,
    closed,
    opened,
)

pytestmark = pytest.mark.serial


def test_closed_blocks_follow_their_pressure(comm):
    numbers = closed(comm)
    assert all(number.met for number in numbers) and len(numbers) == 10
    lag = max(number.foreign_error or 0.0 for number in numbers)
    assert 550.0 * lag == pytest.approx(142.6, abs=0.1)


def test_the_steady_state_follows_from_the_pressure():
    """T = 800 - q/k1 with resistances in series, p = u/Σ(1 - ν²)/E."""
    soft = sum((1.0 - m["poisson_ratio"] ** 2) / m["young_modulus"] for m in (STEEL, ALUMINIUM))
    h = HARMONIC * 1.8e-11 / soft
    flux = 550.0 / (1 / 16.2 + 1 / h + 1 / 210.0)
    assert 800.0 - flux / 16.2 == pytest.approx(456.7045, abs=1e-4)
    assert 250.0 + flux / 210.0 == pytest.approx(276.4828, abs=1e-4)


def test_pressed_and_radiating_blocks_are_at_one_temperature(comm):
    numbers = opened(comm)
    assert all(number.met for number in numbers)
    assert min(number.foreign_error for number in numbers) > 0.06
