"""A finding in words: number, unit, place and time."""

import pytest

from castx.report.summary.finding import Finding, place_text

pytestmark = pytest.mark.serial


def test_a_number_is_shown_in_its_unit_with_place_and_time():
    found = Finding(
        "Largest gap", "a/b", 1.2345678e-4, "µm", "wide", factor=1e6, place=[0.012, -0.04], time=9.5
    )
    assert found.name == "Largest gap: a/b" and found.number == "123.5 µm"
    assert found.where("axisymmetric") == "r 12.0, z -40.0 mm, t = 9.5 s"


def test_a_large_number_has_no_power_of_ten():
    assert Finding("Largest suction", "a/b", 4.814e7, "kPa", "", factor=1e-3).number == "48140 kPa"


def test_what_is_unknown_is_left_out():
    found = Finding("Hot tearing", "a", 0.5, "", "ratio")
    assert found.number == "0.5" and found.where("3d") == ""
    assert place_text([1e-3, 2e-3, 3e-3], "3d") == "x 1.0, y 2.0, z 3.0 mm"
    assert place_text([-1e-17, -0.0, -2e-3], "3d") == "x 0.0, y 0.0, z -2.0 mm"
