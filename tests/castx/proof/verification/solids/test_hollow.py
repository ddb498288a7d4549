import numpy as np
import pytest

from castx.proof.verification.solids.hollow import (
    CYLINDER,
    CYLINDER_PRESSURE,
    SPHERE,
    SPHERE_PRESSURE,
    VERIFICATION,
    Hollow,
)
from castx.proof.verification.verification import Resolution
from tests.castx.proof.verification.coarse_run import coarse_run

pytestmark = pytest.mark.serial


def test_the_numbers_of_the_record():
    assert SPHERE.first_yield == pytest.approx(140.000e6)
    assert SPHERE.limit == pytest.approx(332.7106e6, rel=1e-6)
    assert SPHERE.front(SPHERE_PRESSURE) == pytest.approx(0.1153396, rel=1e-6)
    assert SPHERE.expansion(SPHERE_PRESSURE) == pytest.approx(3.068774e-5, rel=1e-6)
    assert CYLINDER.first_yield == pytest.approx(103.9230e6, rel=1e-6)
    assert CYLINDER.limit == pytest.approx(192.0906e6, rel=1e-6)
    assert CYLINDER.expansion(CYLINDER_PRESSURE) == pytest.approx(6.467049e-5, rel=1e-6)


@pytest.mark.parametrize("hollow", [SPHERE, CYLINDER, Hollow(3, inner=0.03, outer=0.05)])
def test_the_hoop_stress_bears_the_pressure(hollow):
    """Half a sphere and half a cylinder: the pressure on the bore is what the wall pulls."""
    pressure = 0.5 * (hollow.first_yield + hollow.limit)
    r = np.linspace(hollow.inner, hollow.outer, 20001)
    d = hollow.dimension
    pulled = np.trapezoid(hollow.hoop_stress(pressure, r) * r ** (d - 2), r) * (d - 1)
    assert pulled == pytest.approx(pressure * hollow.inner ** (d - 1), rel=1e-6)


def test_a_coarse_run(comm):
    coarse_run(VERIFICATION, comm, Resolution(0.1 / 14))
