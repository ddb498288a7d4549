"""X7 and X8: the states before and after; what is between is compared on the page alone."""

import pytest

from castx.proof.foreign.cases.contact_box import (
    EXPANSION,
    GAP,
    PRESSURE,
    YOUNG,
    case,
    history,
)

pytestmark = pytest.mark.serial


def test_pressed_halves_part(comm):
    found = history(comm, case(308.0, 288.0, 150.0, 10.0, 0.01))
    assert found[0.0]["pressure"] == pytest.approx(PRESSURE, rel=1e-9)
    assert found[0.0]["gap"] == pytest.approx(0.0, abs=1e-15)
    assert pytest.approx(1.1733333e-5, rel=1e-7) == GAP
    assert found[150.0]["gap"] == pytest.approx(GAP, rel=1e-3)
    assert found[150.0]["stress"] == pytest.approx(YOUNG * EXPANSION * 10.0, rel=1e-3)


def test_halves_that_are_apart_meet(comm):
    found = history(comm, case(288.0, 308.0, 150.0, 10.0, 0.01))
    assert found[0.0]["gap"] == pytest.approx(GAP, rel=1e-9) and found[0.0]["pressure"] == 0.0
    assert found[150.0]["pressure"] == pytest.approx(22.88e6, rel=1e-3)
