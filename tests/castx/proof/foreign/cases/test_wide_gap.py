"""X12: a wide gap of cylinders, and what its curvature changes."""

import numpy as np
import pytest

from castx.proof.foreign.cases.wide_gap import CURVED, EXACT, KEPT, found, run

pytestmark = pytest.mark.serial


def test_temperatures_across_the_gap(comm):
    numbers = run(comm)
    assert all(number.met for number in numbers)
    plane = found(comm, None)
    assert plane["T(2.0 m)"] - EXACT["T(2.0 m)"] == pytest.approx(0.05, abs=5e-3)


def test_the_kept_numbers_follow_from_the_radii():
    inner, outer = CURVED["radii"]
    heat = 5e4 * np.pi * inner**2
    wall, hole = EXACT["T(2.0 m)"], EXACT["T(2.2 m)"]
    grey = 1 / (1 / 0.8 + inner / outer * (1 / 0.8 - 1))
    passed = 2 * np.pi * (
        0.1 * (wall - hole) / np.log(outer / inner)
        + inner * grey * 5.670374419e-8 * (wall**4 - hole**4)
    )  # fmt: skip
    assert passed == pytest.approx(heat, rel=2e-5)
    assert KEPT["T(2.0 m)"] == pytest.approx(wall, abs=5e-4)
