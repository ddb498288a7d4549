"""Distributions of inputs by their quantiles, and ranges that are none."""

import math

import pytest

from castx.errors import CaseError
from castx.studies.asked.inputs import VariedInput

pytestmark = pytest.mark.serial


def given(**keys):
    return VariedInput.read({"of": "time.end", **keys})


def test_even_spreads():
    one = given(low="10 mm", high="30 mm")
    assert [one.quantile(u) for u in (0.0, 0.25, 1.0)] == [10.0, 15.0, 30.0]
    assert one.level(0.5) == "20.0 mm"
    assert given(low=1, high=100, distribution="log-uniform").quantile(0.5) == pytest.approx(10.0)


def test_normal_spreads_end_at_one_in_a_thousand():
    one = given(mean=5, deviation=2, distribution="normal")
    assert one.quantile(0.5) == pytest.approx(5.0)
    assert one.quantile(1.0) == pytest.approx(5.0 + 2.0 * 3.0902323)
    # 84.134 % of all lie below one deviation; of those within 0.1 to 99.9 % a share of 0.842...
    assert one.quantile((0.8413447461 - 0.001) / 0.998) == pytest.approx(7.0, rel=1e-8)
    cut = given(mean=5, deviation=2, low=5, distribution="normal")
    assert cut.quantile(0.0) == pytest.approx(5.0)


def test_a_log_normal_one_has_its_median():
    one = given(mean="100 W/m^2/K", deviation=0.5, distribution="log-normal")
    assert one.quantile(0.5) == pytest.approx(100.0)
    assert one.quantile(1.0) == pytest.approx(100.0 * math.exp(0.5 * 3.0902323))
    assert one.unit == "W/m^2/K"


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"low": 1}, 'high: missing; the distribution "uniform" needs low and high'),
        ({"low": 2, "high": 1}, "low = 2: must lie below high|low: must lie below high"),
        ({"low": "1 mm", "high": 2}, "same unit"),
        ({"low": 0, "high": 1, "distribution": "log-uniform"}, "must be positive"),
        ({"mean": 1, "distribution": "normal"}, "deviation: missing"),
        ({"mean": 1, "deviation": -1, "distribution": "normal"}, "must be positive"),
        (
            {"low": 9, "high": 10, "mean": 1, "deviation": 0.1, "distribution": "normal"},
            "mean.*: lies so far outside low and high",
        ),
        ({"low": 1, "high": 2, "distribution": "even"}, "did you mean|allowed: uniform"),
    ],
)
def test_ranges_that_are_none_are_refused(keys, text):
    with pytest.raises(CaseError, match=text):
        given(**keys)
