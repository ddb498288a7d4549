"""X1: the numbers of the other program, the solution and castx agree."""

import pytest

from castx.proof.foreign.cases.exchange_between_walls import run

pytestmark = pytest.mark.serial


def test_all_three_agree(comm):
    for number in run(comm):
        assert number.met and number.foreign == pytest.approx(number.exact, rel=1e-8)
