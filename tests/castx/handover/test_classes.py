"""Classes of equal width: every value within half of a width of the middle of its class."""

import numpy as np
import pytest

from castx.handover.classes import Classes

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("most", [1, 7, 20])
def test_values_lie_in_their_classes(most):
    values = np.random.default_rng(3).uniform(90e6, 130e6, 500)
    found = Classes.of("yield_strength", values, most)
    assert found.width == pytest.approx(np.ptp(values) / most)
    assert len(found.middles) == most and set(found.numbers) == set(range(most))
    apart = np.abs(values - found.middles[found.numbers])
    assert apart.max() <= 0.5 * found.width * (1.0 + 1e-9)


def test_unknown_values_have_no_class_and_equal_ones_a_single_one():
    found = Classes.of("arm_spacing", np.array([2e-5, np.nan, 2e-5]))
    assert found.numbers.tolist() == [0, -1, 0] and found.width == 0.0
    assert found.middles.tolist() == [2e-5]
    assert Classes.of("arm_spacing", np.array([np.nan])).numbers.tolist() == [-1]
