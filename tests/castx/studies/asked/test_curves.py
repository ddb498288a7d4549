"""Measured curves of a study: their noise in units, what is wrong in them."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.curves import SensorCurve

pytestmark = pytest.mark.serial

ONE = {"of": "near.temperature", "file": "a.csv", "noise": "1 K"}


@pytest.mark.parametrize(
    ("of", "noise", "sigma"),
    [
        ("near.temperature", "0.5 K", 0.5),
        ("near.temperature", "0.5 degC", 0.5),
        ("near.temperature", 2, 2.0),
        ("near.displacement.r", "1 um", 1e-6),
    ],
)
def test_noise_is_a_difference_of_its_quantity(of, noise, sigma):
    one = SensorCurve.read({**ONE, "of": of, "noise": noise})
    assert one.sigma == pytest.approx(sigma) and one.probe == "near"


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"noise": 0}, "no sensor is without noise"),
        ({"noise": "1 mm"}, "not a unit of temperature difference"),
        ({"of": "near.temperatur", "noise": "1 mm"}, "a column of probes.csv is needed"),
        ({"direction": [0, 0]}, "a direction is needed"),
        ({"depth_deviation": 0}, "positive"),
    ],
)
def test_what_is_wrong_is_refused(keys, text):
    with pytest.raises(CaseError, match=text):
        SensorCurve.read({**ONE, **keys})


def test_noise_is_needed():
    with pytest.raises(CaseError, match="noise: missing"):
        SensorCurve.read({key: value for key, value in ONE.items() if key != "noise"})
