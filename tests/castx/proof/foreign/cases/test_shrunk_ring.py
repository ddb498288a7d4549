"""X5: the pressure of Lamé's rings, and the sum of their growth that it closes."""

import pytest

from castx.proof.foreign.cases.shrunk_ring import (
    EXPANSION,
    POISSON,
    RADII,
    RISE,
    YOUNG,
    exact_pressure,
    run,
)

pytestmark = pytest.mark.serial


def test_the_rings_press_each_other(comm):
    (number,) = run(comm)
    assert number.met and number.exact == pytest.approx(87.04e6, rel=1e-4)


def test_the_pressure_closes_the_overlap():
    """u(b) of a ring under outer or inner pressure, Timoshenko and Goodier, section 28."""
    (a, b, c), p = RADII, exact_pressure()
    inwards = p * b / YOUNG * ((b**2 + a**2) / (b**2 - a**2) - POISSON)
    outwards = p * b / YOUNG * ((c**2 + b**2) / (c**2 - b**2) + POISSON)
    assert inwards + outwards == pytest.approx(EXPANSION * RISE * b, rel=1e-12)
