"""Temperatures and times of a process, beside Chvorinov's rule and a lump of metal in air."""

import math

import numpy as np
import pytest

from castx.case.processes.plan import COLD, GAP_FACTOR, ShellSize, chosen, plan_of
from castx.case.processes.process import casting_process
from castx.errors import CaseError
from castx.materials.lookup import find_material

pytestmark = pytest.mark.serial

MODULUS = 0.01


def heat(alloy, hot, cold):
    """Return the heat of an alloy between two temperatures [J/m³]."""
    return float(alloy.enthalpy.enthalpy(hot) - alloy.enthalpy.enthalpy(cold))


def test_sand_follows_chvorinov_and_the_resistance_of_its_face():
    plan = plan_of(casting_process("sand"), None, None, MODULUS)
    iron, sand = find_material("GJL-250", {}), find_material("sand-silica", {})
    mean = 0.5 * (iron.solidus + iron.liquidus) - 20.0
    amount = MODULUS * heat(iron, plan.pouring, iron.solidus)
    conductivity = float(sand.description.conductivity.solid(20.0))
    capacity = float(sand.enthalpy.enthalpy(70.0) - sand.enthalpy.enthalpy(20.0)) / 50.0
    chvorinov = math.pi / 4 * (amount / mean) ** 2 / (conductivity * capacity)
    face = GAP_FACTOR * amount / (700.0 * mean)  # h of iron-sand-coated
    assert plan.freezing == pytest.approx(chvorinov + face, rel=0.02)  # two digits
    assert 0.5 * chvorinov < plan.freezing and plan.freezing < plan.release < plan.end
    assert plan.pouring == pytest.approx(iron.liquidus + 120.0, abs=2.5)


def test_a_casting_is_cold_when_a_lump_in_air_is():
    plan = plan_of(casting_process("gravity-die"), None, None, MODULUS)
    alloy = find_material("AlSi7Mg", {})
    hot = 0.8 * alloy.solidus
    capacity = heat(alloy, hot, COLD) / (hot - COLD)
    lump = MODULUS * capacity / 25.0 * math.log((hot - 20.0) / (COLD - 20.0))
    assert plan.end - plan.release == pytest.approx(lump, rel=0.1)
    assert plan.release == pytest.approx(2.0 * plan.freezing, rel=0.05)


@pytest.mark.parametrize("modulus", [0.002, 0.157, 0.1642, 0.1795, 0.2679])
def test_a_casting_of_many_tons_cools_in_air_after_its_sand_is_off(modulus):
    """It stays in sand for weeks, of which the hours in air are a small part."""
    plan = plan_of(casting_process("sand"), None, None, modulus)
    iron = find_material("GJL-250", {})
    hot = 0.4 * iron.solidus
    lump = heat(iron, hot, COLD) / (hot - COLD) / 30.0 * math.log((hot - 20.0) / (COLD - 20.0))
    assert plan.end - plan.release == pytest.approx(modulus * lump, rel=0.06)


def test_thicker_castings_take_longer_and_steel_pours_hotter_than_aluminium():
    sand = casting_process("sand")
    thin, thick = (plan_of(sand, "AlSi7Mg", None, modulus) for modulus in (0.01, 0.02))
    assert 3.0 < thick.freezing / thin.freezing < 4.2
    assert plan_of(sand, "G20Mn5", None, 0.01).pouring > thin.pouring + 800.0
    assert plan_of(sand, "G20Mn5", None, 0.01).interface == "steel-sand-coated"


def test_zinc_is_shot_colder_above_its_liquidus_than_aluminium():
    plan = plan_of(casting_process("high-pressure-die"), "ZnAl4Cu1", None, 0.002)
    assert plan.pouring == 425.0 and plan.interface == "zinc-steel-high-pressure"
    assert plan.process.sources["superheat"].startswith("zinc")
    aluminium = plan_of(casting_process("high-pressure-die"), None, None, 0.002)
    liquidus = find_material("AlSi9Cu3", {}).liquidus
    assert aluminium.pouring == pytest.approx(liquidus + 60.0, abs=2.5)


@pytest.mark.parametrize(
    "process, alloy, interface",
    [
        ("investment", "316L", "steel-investment-shell"),
        ("sand", "316L", "steel-sand-coated"),
        ("sand", "CuZn39Pb1Al", "bronze-sand"),
        ("sand", "GJS-600", "iron-sand-coated"),
    ],
)
def test_a_process_takes_alloys_that_fit_it(process, alloy, interface):
    plan = plan_of(casting_process(process), alloy, None, MODULUS)
    assert plan.interface == interface
    assert 0.0 < plan.freezing < plan.release < plan.end < 1e5


LAYERS = 8


def cooled(modulus, radius, until):
    """Return when a lump of G20Mn5 in a cylindrical shell is as cold as that, by volumes [s]."""
    steel, step = find_material("G20Mn5", {}), 0.25
    edges = radius + np.linspace(0.0, 0.008, LAYERS + 1)
    middles = 0.5 * (edges[1:] + edges[:-1])
    room = 1800.0 * 1050.0 * 0.5 * np.diff(edges**2) / radius  # per area of the casting
    between = 1.2 / (radius * np.log(middles[1:] / middles[:-1]))
    face = 1.0 / (2.0 / 500.0 + radius * math.log(middles[0] / radius) / 1.2)
    skin = radius * math.log(edges[-1] / middles[-1]) / 1.2
    table = np.arange(steel.liquidus + 80.0, 0.0, -1.0)
    content = np.array([heat(steel, table[0], float(at)) for at in table])
    shell, time, given, temperature = np.full(LAYERS, 950.0), 0.0, 0.0, table[0]
    wide = edges[-1] / radius
    outer = 950.0
    while temperature > until:
        for _ in range(3):  # the outside, by its balance
            away = 10.0 * (outer - 20.0) + 0.7 * 5.67e-8 * ((outer + 273.15) ** 4 - 293.15**4)
            slope = 10.0 + 4.0 * 0.7 * 5.67e-8 * (outer + 273.15) ** 3
            outer += (shell[-1] - outer - skin * wide * away) / (1.0 + skin * wide * slope)
        flows = np.concatenate(
            [[face * (temperature - shell[0])], between * -np.diff(shell), [wide * away]]
        )
        shell = shell - step * np.diff(flows) / room
        given += step * flows[0]
        temperature = float(np.interp(given / modulus, content, table))
        time += step
    return time


@pytest.mark.parametrize("radius", [1e3, 0.02])
def test_a_shell_stores_heat_and_its_outside_radiates(radius):
    outer = radius + 0.008
    shell = ShellSize((outer**2 - radius**2) / (2.0 * radius), outer / radius)
    plan = plan_of(casting_process("investment"), None, None, MODULUS, shell)
    solidus = find_material("G20Mn5", {}).solidus
    assert plan.freezing == pytest.approx(cooled(MODULUS, radius, solidus), rel=0.06)
    assert plan.release == pytest.approx(cooled(MODULUS, radius, 0.25 * solidus), rel=0.06)


def test_a_shell_is_even_by_default():
    investment = casting_process("investment")
    even = plan_of(investment, None, None, MODULUS, ShellSize(0.008, 1.0))
    assert plan_of(investment, None, None, MODULUS) == even


@pytest.mark.parametrize(
    "process, mould, law",
    [
        ("sand", None, "drucker-prager"),
        ("sand", "sand-chromite", "drucker-prager"),
        ("sand", "insulation-fibre", "rigid"),
        ("investment", None, "rigid"),
        ("gravity-die", None, "thermo-elastic"),
    ],
)
def test_moulds_of_sand_yield_where_their_material_has_the_numbers(process, mould, law):
    assert plan_of(casting_process(process), None, mould, MODULUS).mould_law == law


@pytest.mark.parametrize(
    "process, mould",
    [("gravity-die", "GJL-250"), ("gravity-die", "Cu-pure"), ("continuous", "CuSn12")],
)
def test_a_mould_may_be_another_metal_that_stays_solid(process, mould):
    assert chosen(casting_process(process), None, mould).mould == mould


@pytest.mark.parametrize(
    "process, alloy, mould, text",
    [
        ("sand", "AlSi8", None, "--alloy: no material 'AlSi8'"),
        ("sand", "steel-H13", None, "steel-H13 has no latent heat"),
        ("sand", None, "sandy", "--mould: no material 'sandy'"),
        ("gravity-die", "GJL-250", None, "no heat transfer between cast iron and the mould of"),
        (
            "gravity-die",
            "CuSn12",
            None,
            "--alloy: CuSn12: .* known classes: aluminium; processes for copper: sand; castx inter",
        ),
        (
            "sand",
            "GJL-250",
            "AlSi7Mg",
            "AlSi7Mg is no mould of sand for GJL-250, poured at 1315 °C",
        ),
        ("sand", None, "steel-H13", "known: insulation-fibre, sand-chromite, sand-silica"),
        ("gravity-die", None, "sand-silica", "--mould: sand-silica is no mould of gravity-die"),
        ("high-pressure-die", None, "AZ91", "AZ91 is no mould of high-pressure-die for AlSi9Cu3"),
        ("investment", None, "steel-H13", "steel-H13 is no mould of investment for G20Mn5"),
    ],
)
def test_what_is_not_known_is_refused(process, alloy, mould, text):
    with pytest.raises(CaseError, match=text):
        plan_of(casting_process(process), alloy, mould, MODULUS)
