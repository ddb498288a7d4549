"""When a strand is solid: what it loses, and times of slow and of fast cooling by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from castx.case.processes.strand_freezing import StrandCooling, solid_after
from castx.materials.lookup import find_material
from castx.tables import Table

pytestmark = pytest.mark.serial

SPRAYS = [Table(np.array([700.0, 1200.0]), np.array([800.0, 300.0])), Table.constant(100.0)]
COOLING = StrandCooling(2000.0, [10.0, 20.0, 40.0], SPRAYS, 30.0, 0.8, 10.0)
NEVER = [1e6, 2e6, 3e6]


def test_what_is_lost_in_mould_sprays_and_air():
    surface = np.array([800.0, 1200.0])
    for time, coefficients in ((9.9, [2000, 2000]), (10.0, [700, 300]), (39.0, [100, 100])):
        np.testing.assert_allclose(COOLING.flux(time, surface), coefficients * (surface - 30.0))
    radiated = 0.8 * 5.670374e-8 * (np.array([1073.15, 1473.15]) ** 4 - 293.15**4)
    expected = radiated + 10.0 * (surface - 20.0)
    np.testing.assert_allclose(COOLING.flux(40.0, surface), expected, rtol=1e-6)


def test_slow_cooling_is_that_of_a_lump():
    """It loses h (T − T_w) over its perimeter, t = A/(U h) ∫ dH/(T − T_w), until its core is solid.

    The surface is colder than that by h d/(4k) (T − T_w) of a plate, 34 K, and its edges by more.
    """
    metal, modulus = find_material("316L", {}), 0.01 / 4.0
    slow = replace(COOLING, mould=300.0, starts=NEVER)
    times = []
    for coldest in (metal.solidus, metal.solidus - 80.0):
        temperature = np.linspace(1480.0, coldest, 2001)
        lost = -np.diff(metal.enthalpy.enthalpy(temperature))
        above = 0.5 * (temperature[1:] + temperature[:-1]) - 30.0
        times.append(modulus / 300.0 * np.sum(lost / above))
    assert times[1] < 1.2 * times[0]
    assert times[0] < solid_after(metal, 1480.0, (0.01, 0.01), slow) < times[1]


def test_fast_cooling_takes_times_as_the_squares_of_the_thickness():
    """And less in a square than in a strand so wide that its edges count for nothing."""
    metal, fast = find_material("316L", {}), replace(COOLING, mould=1e6, starts=NEVER)
    thin, thick = (solid_after(metal, 1480.0, (d, 4.0 * d), fast) for d in (0.05, 0.1))
    assert thick == pytest.approx(4.0 * thin, rel=0.02)
    wider = solid_after(metal, 1480.0, (0.05, 0.3), fast)
    assert wider == pytest.approx(thin, rel=0.02)
    square = solid_after(metal, 1480.0, (0.05, 0.05), fast)
    assert 0.5 * thin < square < 0.8 * thin


def test_air_takes_the_longer_the_earlier_it_comes():
    metal = find_material("316L", {})
    early, late = (
        solid_after(metal, 1480.0, (0.1, 0.1), replace(COOLING, starts=[at, at + 10.0, at + 30.0]))
        for at in (10.0, 60.0)
    )
    assert early > 1.1 * late
