"""Second divided differences: of lines, parabolas and one curve by hand; what they hold smooth."""

import numpy as np
import pytest

from castx.foundry.identification.covariance import deviations, posterior
from castx.foundry.identification.smoothness import second_differences

pytestmark = pytest.mark.serial

KNOTS = np.array([0.0, 1.0, 3.0, 8.0, 20.0, 40.0, 60.0])


def test_lines_are_smooth_and_parabolas_have_one():
    place = np.log1p(KNOTS)
    rough = second_differences(KNOTS)
    assert rough.shape == (5, 7)
    np.testing.assert_allclose(rough @ (2.0 - 3.0 * place), 0.0, atol=1e-13)
    np.testing.assert_allclose(rough @ place**2, 1.0, rtol=1e-12)


def test_three_knots_by_hand():
    """At ln(1 + t) = 0, 1, 3 the values 0, 1, 0: slopes 1 and -1/2, over 3: -1/2."""
    found = second_differences(np.expm1([0.0, 1.0, 3.0])) @ np.array([0.0, 1.0, 0.0])
    assert found == pytest.approx([-0.5], rel=1e-12)


def test_the_smoother_the_less_a_knot_without_samples_is_free():
    """Two knots are seen, the third one lies on their line, with γ² times a known factor."""
    seen = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    rough = second_differences(np.expm1([0.0, 1.0, 2.0]))
    for gamma in (0.1, 1.0):
        found = deviations(posterior(seen, np.array(0.01), smoothness=rough / gamma))
        assert found[2] == pytest.approx(np.sqrt(5.0 * 0.01**2 + (2.0 * gamma) ** 2), rel=1e-9)


def test_times_that_do_not_rise_are_refused():
    for time in ([0.0, 1.0], [0.0, 2.0, 2.0]):
        with pytest.raises(ValueError, match="three knots at rising times"):
            second_differences(np.array(time))
