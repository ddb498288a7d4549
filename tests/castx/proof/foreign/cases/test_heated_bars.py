"""X6: the stress of a held bar while it yields, and its closed form."""

import pytest

from castx.proof.foreign.cases.heated_bars import EXACT, TANGENT, YOUNG, run

pytestmark = pytest.mark.serial


def test_the_bar_yields_along_its_closed_form(comm):
    assert all(number.met for number in run(comm))


def test_the_closed_form():
    """-σ = 400 (1 - 0.01 T) + H p and σ/E - p + α T = 0, from 66.667 °C on, in MPa."""
    modulus = 1e-6 * YOUNG * TANGENT / (YOUNG - TANGENT)
    for temperature, stress in EXACT.items():
        plastic = 1e-5 * temperature + stress / (1e-6 * YOUNG)
        assert -stress == pytest.approx(4.0 * (100.0 - temperature) + modulus * plastic, rel=1e-5)
