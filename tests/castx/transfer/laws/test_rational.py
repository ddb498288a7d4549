"""The law that falls with the square of the gap."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.errors import CaseError
from tests.castx.transfer.law_samples import FALLING, PRESSURE, coefficient

pytestmark = pytest.mark.serial

RATIONAL = {"law": "rational", "closed": "2 kW/m^2/K", "half_gap": "0.1 mm"}


def test_numbers_by_hand():
    found = coefficient(RATIONAL, [0.0, 0.5e-4, 1e-4, 2e-4, 3e-4, 1.0])
    expected = [2000.0, 1600.0, 1000.0, 400.0, 200.0, 2000.0 / 100_000_001.0]
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_the_half_gap_counts():
    assert coefficient(RATIONAL | {"half_gap": "50 um"}, 1e-4) == pytest.approx(400.0, rel=1e-14)


def test_it_is_level_at_closure():
    """The first micrometre takes a ten-thousandth; a law by g/g0 would lose a hundredth."""
    lost = 2000.0 - coefficient(RATIONAL, 1e-6)
    assert lost == pytest.approx(2000.0 * 1e-4, rel=2e-4)


def test_pressure_adds_to_touching_surfaces_and_temperature_scales_all_gaps():
    added = coefficient(RATIONAL | {"pressure": PRESSURE}, 0.0, 1e7) - 2000.0
    np.testing.assert_allclose(added, (1e7 / 1.2e9) ** 0.95 / 1.6666667e-5, rtol=1e-9)
    hot = coefficient(RATIONAL | {"closed": FALLING}, 2e-4, secondary=300.0, primary=300.0)
    np.testing.assert_allclose(hot, 1500.0 / 5.0, rtol=1e-14)


@pytest.mark.parametrize("wrong", [{}, {"half_gap": 0.0}, {"half_gap": "3 K"}])
def test_a_half_gap_is_needed(wrong):
    with pytest.raises(CaseError, match="half_gap"):
        InterfaceHeat.read({"law": "rational", "closed": 2000.0} | wrong)
