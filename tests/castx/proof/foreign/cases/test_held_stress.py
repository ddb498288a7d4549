"""X13 and X14: hardening that changes with temperature, by its closed form."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from castx.proof.foreign.cases.held_stress import isotropic, kinematic

pytestmark = pytest.mark.serial


def test_isotropic_hardening_stops_where_it_grows_faster_than_the_yield_stress_falls(comm):
    numbers = isotropic(comm)
    assert all(number.met for number in numbers)

    def p(T):  # 210 = 200 - 1.7 T + (100 + 1.7 T)(1 - exp(-(50 + 2 T) p))
        return -np.log(1 - (10 + 1.7 * T) / (100 + 1.7 * T)) / (50 + 2 * T)

    largest = minimize_scalar(lambda T: -p(T), (0.0, 100.0))
    assert largest.x == pytest.approx(45.2, abs=0.2)
    assert numbers[-1].exact == pytest.approx(-largest.fun, rel=1e-5)


def test_kinematic_hardening_yields_back(comm):
    numbers = kinematic(comm)
    assert all(number.met for number in numbers)
    assert numbers[-1].exact == pytest.approx(8.0e-4)
    assert (1e3 + 2990 * 12.658) * 0.01 == pytest.approx(410 - 1.7 * 12.658, rel=1e-4)
