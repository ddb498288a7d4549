"""Errors of numbers of castx and of another program, and what is met."""

from __future__ import annotations

import pytest

from castx.proof.foreign.declaration import Number

pytestmark = pytest.mark.serial


def test_errors_are_shares_of_the_exact_number_or_of_a_scale():
    share = Number.relative("gap", 4.2e-5, 3.9e-5, 4.0e-5, "m", 0.03)
    assert share.error == pytest.approx(0.025) and share.foreign_error == pytest.approx(0.05)
    scaled = Number("T", 21.0, 20.5, 20.0, "°C", 1e-3, 500.0)
    assert scaled.error == pytest.approx(1e-3) and scaled.foreign_error == pytest.approx(2e-3)


@pytest.mark.parametrize(
    ("computed", "met"), [(3.9e-5, True), (3.8e-5, False), (float("nan"), False)]
)
def test_a_number_is_met_within_its_tolerance_alone(computed, met):
    found = Number.relative("gap", None, computed, 4.0e-5, "m", 0.03)
    assert found.met is met and found.foreign_error is None
