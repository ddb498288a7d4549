"""Speed, times, water and pressure of a strand, beside numbers worked out by hand."""

import math

import numpy as np
import pytest

from castx.case.processes.process import casting_process
from castx.case.processes.strand import (
    SPRAYED,
    StrandSection,
    liquid_density,
    spray_coefficient,
    strand_plan_of,
)
from castx.errors import CaseError
from castx.materials.lookup import find_material
from castx.materials.material import Material

pytestmark = pytest.mark.serial

BILLET = StrandSection(2, 0.0169, 0.52, (0.13, 0.13))
SLAB = StrandSection(2, 0.25 * 1.5, 3.5, (1.5, 0.25))
CONTINUOUS = casting_process("continuous")


def test_a_billet_runs_at_the_speed_of_its_perimeter_over_its_area():
    strand = strand_plan_of(CONTINUOUS, None, None, BILLET)
    assert 60.0 * strand.speed == pytest.approx(2.0)  # 60 · 0.0011 · 0.52/0.0169 = 2.03 m/min
    assert strand.plan.release == 21.0  # 0.7 m at 2 m/min
    assert [zone.start for zone in strand.zones] == [21.0, 30.0, 75.0]  # 9 s, 45 s, 60 s
    assert strand.air == 135.0
    assert [zone.water for zone in strand.zones] == [8.0, 2.5, 1.7]
    assert strand.plan.freezing == 380.0
    assert strand.plan.end == 490.0  # 1.3 times that
    assert strand.taper == pytest.approx(0.5 * 0.009 * 0.7)
    steel = find_material("316L", {})
    assert strand.plan.pouring == pytest.approx(steel.liquidus + 30.0, abs=2.5)
    assert strand.plan.interface == "steel-copper-cooled" and strand.rolls_end is None


def solid_after(strand, cells=16):
    """Return when the core of a strand is solid [s], by heat in finite volumes of a quarter.

    It touches the mould all the time, so that it loses more heat there than behind gaps.
    """
    steel = find_material(strand.plan.alloy, {})
    curve, conductivity = steel.enthalpy, steel.conductivity
    size = 0.5 * strand.section.thickness / cells
    shape = tuple(round(0.5 * extent / size) for extent in strand.section.extents)
    heat = np.full(shape, float(curve.enthalpy(np.array(strand.plan.pouring))))
    time, step = 0.0, 0.2 * size**2 * 480.0 * steel.density / 31.0
    starts = [zone.start for zone in strand.zones]
    in_mould = 1.0 / (1.0 / 2200.0 + 0.012 / 390.0 + 1.0 / 30000.0)

    def lost(surface):
        if time < strand.plan.release:
            return in_mould * (surface - 30.0)
        if time >= strand.air:
            hot, cold = surface + 273.15, 293.15
            return 0.8 * 5.670374e-8 * (hot**4 - cold**4) + 10.0 * (surface - 20.0)
        zone = strand.zones[sum(start <= time for start in starts) - 1]
        return np.interp(surface, SPRAYED, zone.coefficients) * (surface - 30.0)

    while time < 4.0 * strand.plan.end:
        temperature, fraction = curve.temperature(heat), curve.solid_fraction(heat)
        if fraction[-1, -1] >= 1.0:
            return time
        leads = conductivity(temperature, fraction)
        for axis in (0, 1):
            t, k, h = (np.moveaxis(field, axis, 0) for field in (temperature, leads, heat))
            inwards = 2.0 * k[1:] * k[:-1] / (k[1:] + k[:-1]) * (t[:-1] - t[1:]) / size
            surface = t[0]
            for _ in range(20):
                surface = 0.5 * (surface + t[0] - 0.5 * size * lost(surface) / k[0])
            h[1:] += step / size * inwards
            h[:-1] -= step / size * inwards
            h[0] -= step / size * lost(surface)
        time += step
    raise AssertionError("never solid")


@pytest.mark.parametrize(
    "width, thickness, alloy",
    [(0.13, 0.13, "316L"), (0.2, 0.16, "G20Mn5"), (0.6, 0.15, "316L"), (1.5, 0.25, "316L")],
)
def test_a_first_run_goes_on_until_its_strand_is_solid(width, thickness, alloy):
    """Billet, bloom and slabs; the time that is told has two digits."""
    area, perimeter = width * thickness, 2.0 * (width + thickness)
    section = StrandSection(2, area, perimeter, (width, thickness))
    strand = strand_plan_of(CONTINUOUS, alloy, None, section)
    known = solid_after(strand)
    assert known < strand.plan.end
    assert strand.plan.freezing == pytest.approx(known, rel=0.03)


def test_the_pool_presses_by_its_height_on_the_bow():
    strand = strand_plan_of(CONTINUOUS, None, None, BILLET)
    density = liquid_density(find_material("316L", {}))
    radius = 40 * 0.13
    assert strand.pressure[0] == (0.0, 0.0)
    for time, pressure in strand.pressure[1:]:
        arc = strand.speed * time
        assert pressure == pytest.approx(density * 9.81 * radius * math.sin(arc / radius), rel=5e-3)
    time, pressure = strand.pressure[-1]
    assert strand.speed * time == pytest.approx(0.5 * math.pi * radius, rel=1e-3)
    assert pressure == pytest.approx(density * 9.81 * radius, rel=5e-3)


def test_rolls_bear_the_pressure_of_a_wide_strand_below_its_mould():
    strand = strand_plan_of(CONTINUOUS, None, None, SLAB)
    time, pressure = strand.pressure[-1]
    assert time == pytest.approx(strand.plan.release, rel=0.02) and pressure > 0.0
    assert strand.plan.freezing == 1700.0
    assert strand.rolls_end == pytest.approx(1.15 * 1700.0, rel=0.03)
    assert strand.speed < strand_plan_of(CONTINUOUS, None, None, BILLET).speed


def test_rolls_go_on_as_long_as_sprays():
    """A thin strand is solid before its sprays end, as far behind the meniscus as all others."""
    thin = StrandSection(2, 0.25 * 0.01, 0.52, (0.25, 0.01))
    strand = strand_plan_of(CONTINUOUS, None, None, thin)
    assert strand.plan.freezing < strand.air < strand.rolls_end < strand.plan.end


def test_molten_steel_is_lighter_than_cold_steel():
    """By expansion up to the solidus, 20.5e-6 over 1365 K, and the shrinkage, 0.038."""
    steel = find_material("316L", {})
    expected = 7955.0 * (1.0 - 0.038) / (1.0 + 20.5e-6 * 1365.0) ** 3
    assert liquid_density(steel) == pytest.approx(expected, rel=1e-6)
    plain = Material("plain", steel.description.model_copy(update={"expansion": None}))
    assert liquid_density(plain) == pytest.approx(7955.0 * (1.0 - 0.038))


def test_water_takes_what_was_measured():
    """In SI the formula is 708 W^0.75 T^-1.2 + 0.116 kW/m²/K."""
    for water in (1.7, 8.0):
        for temperature in SPRAYED:
            known = 1e3 * (708.0 * water**0.75 * temperature**-1.2 + 0.116)
            assert spray_coefficient(water, temperature) == pytest.approx(known, rel=5e-3)
    foot = strand_plan_of(CONTINUOUS, None, None, BILLET).zones[0]
    assert foot.coefficients[0] == float(f"{spray_coefficient(8.0, 700.0):.2g}")
    assert sorted(foot.coefficients, reverse=True) == list(foot.coefficients)


@pytest.mark.parametrize(
    "alloy, text",
    [
        ("AlSi7Mg", "no heat transfer between aluminium and the mould of continuous is known"),
        ("steel-H13", "has no latent heat"),
        ("G20", "--alloy: no material 'G20'"),
    ],
)
def test_what_is_not_known_is_refused(alloy, text):
    with pytest.raises(CaseError, match=text):
        strand_plan_of(CONTINUOUS, alloy, None, BILLET)
