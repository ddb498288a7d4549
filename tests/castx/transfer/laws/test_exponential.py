"""The law that decays with the gap."""

from __future__ import annotations

import math

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.errors import CaseError
from tests.castx.transfer.law_samples import FALLING, PRESSURE, coefficient

pytestmark = pytest.mark.serial

DECAYING = {"law": "exponential", "closed": "2 kW/m^2/K", "decay_length": "0.1 mm"}


def test_numbers_by_hand():
    found = coefficient(DECAYING, [0.0, 1e-4, 2e-4, 1.0])
    expected = [2000.0, 2000.0 / math.e, 2000.0 / math.e**2, 0.0]
    np.testing.assert_allclose(found, expected, rtol=1e-14)


def test_the_decay_length_counts():
    longer = coefficient(DECAYING | {"decay_length": "0.2 mm"}, 1e-4)
    np.testing.assert_allclose(longer, 2000.0 * math.exp(-0.5), rtol=1e-14)


def test_pressure_adds_to_touching_surfaces_and_temperature_scales_all_gaps():
    added = coefficient(DECAYING | {"pressure": PRESSURE}, 0.0, 1e7) - 2000.0
    np.testing.assert_allclose(added, (1e7 / 1.2e9) ** 0.95 / 1.6666667e-5, rtol=1e-9)
    hot = coefficient(DECAYING | {"closed": FALLING}, 1e-4, secondary=300.0, primary=300.0)
    np.testing.assert_allclose(hot, 1500.0 / math.e, rtol=1e-14)


@pytest.mark.parametrize("wrong", [{}, {"decay_length": 0.0}, {"decay_length": "3 K"}])
def test_a_decay_length_is_needed(wrong):
    with pytest.raises(CaseError, match="decay_length"):
        InterfaceHeat.read({"law": "exponential", "closed": 2000.0} | wrong)
