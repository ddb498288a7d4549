"""The law whose coefficient follows the solid fraction of the casting."""

from __future__ import annotations

import pytest

from castx.transfer.conductance import SOLID
from tests.castx.transfer.law_samples import FALLING, coefficient, conductance

pytestmark = pytest.mark.serial


def test_solid_fraction_law():
    heat = {"law": "solid-fraction", "closed": 2000, "open": 200}
    assert coefficient(heat, solid=0.0) == pytest.approx(2000.0)
    assert coefficient(heat, solid=1.0) == pytest.approx(200.0)
    found = conductance(heat, solid=0.25)
    assert found.coefficient.value == pytest.approx(1550.0)
    assert found.contact == pytest.approx(1500.0 / 1550.0)
    assert found.coefficient.slopes[SOLID] == pytest.approx(-1800.0)


def test_both_coefficients_vary_with_their_own_temperature():
    of_mould = {**FALLING, "of": "primary"}
    heat = {"law": "solid-fraction", "closed": FALLING, "open": of_mould}
    # closed at 500 °C: 900, open at 200 °C: 1200
    assert coefficient(heat, solid=0.25) == pytest.approx(0.75 * 900.0 + 0.25 * 1200.0)
