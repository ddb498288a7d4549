"""Indices of Clyne and Davies and of Kou, by closed forms."""

import numpy as np
import pytest

from castx.foundry.hot_tearing import clyne_davies, clyne_davies_of_alloy, kou
from castx.foundry.mush import FreezingPath
from castx.materials.solid_fraction import LinearLaw, ScheilLaw, TabulatedLaw

pytestmark = pytest.mark.serial


def scheil(partition, depression, solidus):
    return FreezingPath(ScheilLaw(partition, 660.3), solidus, 660.3 - depression)


def test_a_linear_law_by_temperature():
    assert clyne_davies_of_alloy(FreezingPath(LinearLaw(), 560.0, 615.0)) == pytest.approx(0.18)


@pytest.mark.parametrize(("partition", "value"), [(0.13, 8.121778), (0.17, 7.443063)])
def test_an_alloy_by_scheil(partition, value):
    assert clyne_davies_of_alloy(scheil(partition, 1.0, 400.0)) == pytest.approx(value, rel=1e-6)


def test_without_time_for_relief_an_alloy_has_an_infinite_index():
    law = TabulatedLaw(((500.0, 1.0), (580.0, 0.95), (580.0, 0.2), (600.0, 0.0)))
    assert clyne_davies_of_alloy(FreezingPath(law, 500.0, 600.0)) == np.inf


def test_by_times_it_is_their_ratio():
    times = (
        np.array([1.0, 2.0, 2.0, 2.0]),
        np.array([3.0, 2.5, 2.0, 2.0]),
        np.array([4, 4.5, 3, 2]),
    )
    np.testing.assert_array_equal(clyne_davies(*times), [0.5, 4.0, np.inf, np.nan])


def test_times_of_a_chilled_wall():
    """V3: x²/η² of the similarity solution at f = 0.4, 0.9, 0.99, with x = 1 m."""
    times = [np.array(time) for time in (12935.8123, 16803.3460, 17562.2216)]
    assert clyne_davies(*times) == pytest.approx(0.196217, rel=1e-5)


def test_a_eutectic_ends_the_vulnerable_range():
    path = scheil(0.17, 14.3, 548.0)  # 0.0891 of eutectic liquid: f = 0.99 is at the solidus
    first, last = (660.3 - 14.3 * liquid ** (0.17 - 1.0) for liquid in (0.6, 0.1))
    assert clyne_davies_of_alloy(path) == pytest.approx((last - 548.0) / (first - last), rel=1e-9)


def test_kou_of_scheil_is_largest_at_the_end():
    path = scheil(0.17, 14.3, 400.0)
    assert kou(path) == pytest.approx(3962.701, rel=1e-5)
    assert kou(path, (0.6, 0.87)) == pytest.approx(926.1630, rel=1e-5)


def test_kou_ends_where_the_eutectic_begins():
    begin = 0.91
    solidus = 660.3 - 14.3 * (1.0 - begin) ** (0.17 - 1.0)
    exact = 2.0 * np.sqrt(begin) * 0.83 * 0.09 ** (0.17 - 2.0) * 14.3
    assert kou(scheil(0.17, 14.3, solidus)) == pytest.approx(exact, rel=1e-5)


def test_kou_of_a_table_takes_its_steepest_row():
    law = TabulatedLaw(((500.0, 1.0), (540.0, 0.92), (544.0, 0.88), (560.0, 0.5), (600.0, 0.0)))
    exact = 2.0 * np.sqrt(0.94) * 40.0 / 0.08
    assert kou(FreezingPath(law, 500.0, 600.0)) == pytest.approx(exact, rel=1e-9)


def test_kou_of_what_freezes_at_one_temperature_is_none():
    law = TabulatedLaw(((500.0, 1.0), (520.0, 0.95), (520.0, 0.8), (600.0, 0.0)))
    assert kou(FreezingPath(law, 500.0, 600.0)) == 0.0
