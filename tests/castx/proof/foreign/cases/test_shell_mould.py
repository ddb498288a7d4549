"""X9: with steps twenty times as large the temperatures are near, and not within the tolerance."""

import pytest

from castx.proof.foreign.cases.shell_mould import EXACT, KEPT, PLACES, run

pytestmark = pytest.mark.serial


def test_the_metal_freezes_towards_the_middle(comm):
    numbers = run(comm, 0.1)
    assert len(numbers) == len(EXACT) * len(PLACES)
    assert 3e-3 < max(number.error for number in numbers) < 4e-2
    warm = [number.computed for number in numbers]
    for start in range(0, len(warm), len(PLACES)):
        outwards = warm[start : start + len(PLACES)]
        assert sorted(outwards, reverse=True) == outwards


def test_the_other_program_is_near_the_solution():
    for time, exact in EXACT.items():
        assert KEPT[time] == pytest.approx(exact, abs=2e-3)
