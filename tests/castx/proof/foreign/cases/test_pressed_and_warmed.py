"""X10 and X11: blocks pressed together by expansion, or unevenly on meshes that do not match."""

import pytest

from castx.proof.foreign.cases.pressed_and_warmed import HARDNESS, uneven, warmed

pytestmark = pytest.mark.serial


def test_expansion_presses_as_in_the_other_program(comm):
    numbers = warmed(comm)
    assert all(number.met for number in numbers) and len(numbers) == 15
    assert pytest.approx(26.875) == HARDNESS


def test_an_uneven_pressure_presses_and_conducts_unevenly(comm):
    """The mean is that of the balance; by it alone the aluminium would be 2 K colder at 0.5 s."""
    numbers = {number.name: number for number in uneven(comm)}
    assert all(number.met for number in numbers.values()) and len(numbers) == 15
    assert numbers["mean T of the aluminium, 0.5 s"].computed > 576.11 + 1.5
    assert numbers["largest pressure, 1 s"].computed > 3 * numbers["least pressure, 1 s"].computed
