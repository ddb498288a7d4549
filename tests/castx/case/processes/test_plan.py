"""Temperatures and times of a process, beside Chvorinov's rule and a lump of metal in air."""

import csv
import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

import castx
from castx.case.processes.names import process_names
from castx.case.processes.plan import COLD, ShellSize, chosen, plan_of
from castx.case.processes.process import casting_process
from castx.errors import CaseError
from castx.materials.lookup import find_material
from castx.transfer.database import interface_entry

pytestmark = pytest.mark.serial

MODULUS = 0.01


def heat(alloy, hot, cold):
    """Return the heat of an alloy between two temperatures [J/m³]."""
    return float(alloy.enthalpy.enthalpy(hot) - alloy.enthalpy.enthalpy(cold))


def test_sand_follows_chvorinov_and_the_resistance_of_its_face():
    """Iron swells as it freezes: its face stays closed, and radiates beside what it conducts."""
    plan = plan_of(casting_process("sand"), None, None, MODULUS)
    iron, sand = find_material("GJL-250", {}), find_material("sand-silica", {})
    mean = 0.5 * (iron.solidus + iron.liquidus) - 20.0
    amount = MODULUS * heat(iron, plan.pouring, iron.solidus)
    conductivity = float(sand.description.conductivity.solid(0.5 * (20.0 + iron.solidus)))
    capacity = heat(sand, iron.solidus, 20.0) / (iron.solidus - 20.0)
    chvorinov = math.pi / 4 * (amount / mean) ** 2 / (conductivity * capacity)
    radiates = 5.67e-8 * 4.0 * (mean + 293.15) ** 3 / (1.0 / 0.85 + 1.0 / 0.9 - 1.0)
    face = amount / ((700.0 + radiates) * 0.25 * mean)  # a quarter of it, as the sand is hot
    assert chvorinov < plan.freezing < chvorinov + face
    assert plan.freezing < plan.release < plan.end
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


@dataclass(frozen=True)
class Lump:
    """A lump of an alloy in a cylindrical wall, cooled by explicit steps of its layers.

    Attributes:
        alloy: its name.
        poured: at this temperature [°C].
        closed: coefficient of its face [W/m²/K].
        emissivity: of both surfaces of the face together.
        conductivity: of the wall [W/m/K].
        capacity: of the wall [J/m³/K].
        warm: temperature of the wall at the start [°C].
        outside: coefficient, emissivity and temperature of its surroundings.
        step: [s].
    """

    alloy: str
    poured: float
    closed: float
    emissivity: float
    conductivity: float
    capacity: float
    warm: float
    outside: tuple[float, float, float]
    step: float

    def cooled(self, modulus, radius, wall, until, layers=8):
        """Return when its mean temperature is as low as that [s].

        Its surface follows the flux of the step before, by a tenth of the way.
        """
        metal, (away, grey, ambient) = find_material(self.alloy, {}), self.outside
        edges = radius + np.linspace(0.0, wall, layers + 1)
        middles = 0.5 * (edges[1:] + edges[:-1])
        room = self.capacity * 0.5 * np.diff(edges**2) / radius  # per area of the casting
        between = self.conductivity / (radius * np.log(middles[1:] / middles[:-1]))
        inner = radius * math.log(middles[0] / radius) / self.conductivity
        skin = radius * math.log(edges[-1] / middles[-1]) / self.conductivity
        table = np.arange(self.poured, 0.0, -1.0)
        content = np.array([heat(metal, table[0], float(at)) for at in table])
        expansion = metal.description.expansion
        solid = metal.solid_fraction_at(table)
        start = metal.contraction_start  # the mean expansion counts from there
        cold = np.minimum(table, start)
        reference = metal.expansion_reference
        reference = start if reference is None else reference
        strain = 3.0 * (
            expansion(cold) * (cold - reference) - expansion(start) * (start - reference)
        )
        strain -= metal.description.solidification_shrinkage * np.maximum(
            solid - metal.fed_until, 0.0
        )
        depth = modulus / 3.0 / float(metal.description.conductivity.solid(metal.solidus))
        shell, time, given, mean = np.full(layers, self.warm), 0.0, 0.0, table[0]
        surface, outer, wide = mean, self.warm, edges[-1] / radius
        while mean > until:
            for _ in range(3):  # the outside, by its balance
                fourth = (outer + 273.15) ** 4 - (ambient + 273.15) ** 4
                leaves = away * (outer - ambient) + grey * 5.67e-8 * fourth
                slope = away + 4.0 * grey * 5.67e-8 * (outer + 273.15) ** 3
                outer += (shell[-1] - outer - skin * wide * leaves) / (1.0 + skin * wide * slope)
            gap = modulus * max(-float(np.interp(-surface, -table, strain)), 0.0)
            air = np.interp(0.5 * (surface + shell[0]), AIR[0], AIR[1])
            a, b = surface + 273.15, shell[0] + 273.15
            face = 1.0 / (1.0 / self.closed + gap / air)
            face += self.emissivity * 5.67e-8 * (a**4 - b**4) / (a - b)
            flux = (surface - shell[0]) / (inner + 1.0 / face)
            surface += 0.1 * (mean - depth * flux - surface)
            flux = (mean - surface) / depth if time > 0.0 else flux
            flows = np.concatenate([[flux], between * -np.diff(shell), [wide * leaves]])
            shell = shell - self.step * np.diff(flows) / room
            given += self.step * flux
            mean = float(np.interp(given / modulus, content, table))
            time += self.step
        return time


AIR = (
    [20.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0],
    [0.0257, 0.0314, 0.038, 0.0441, 0.05, 0.0556, 0.0611, 0.0665, 0.0716, 0.0764, 0.0808],
)
"""Temperatures and conductivities of the gas of all interfaces."""
IN_SHELL = Lump("G20Mn5", 1590.0, 500.0, 1 / (1 / 0.8 + 1 / 0.7 - 1), 1.2, 1.89e6, 950.0,
                (10.0, 0.7, 20.0), 0.05)  # fmt: skip
IN_DIE = Lump("ZnAl4Cu1", 425.0, 15000.0, 1 / (1 / 0.2 + 1 / 0.8 - 1), 0.0, 0.0, 200.0,
              (1500.0, 0.0, 150.0), 1e-3)  # fmt: skip


def wall_of(radius, thickness):
    """Return the size of a cylindrical wall."""
    outer = radius + thickness
    return ShellSize((outer**2 - radius**2) / (2.0 * radius), outer / radius)


@pytest.mark.parametrize("radius", [1e3, 0.02])
def test_a_shell_stores_heat_and_its_outside_radiates(radius):
    plan = plan_of(casting_process("investment"), None, None, MODULUS, wall_of(radius, 0.008))
    solidus = find_material("G20Mn5", {}).solidus
    assert plan.pouring == IN_SHELL.poured
    freezing = IN_SHELL.cooled(MODULUS, radius, 0.008, solidus)
    assert plan.freezing == pytest.approx(freezing, rel=0.06)
    release = IN_SHELL.cooled(MODULUS, radius, 0.008, 0.25 * solidus)
    assert plan.release == pytest.approx(release, rel=0.06)


@pytest.mark.parametrize("modulus", [0.001, 0.004])
def test_a_gap_by_the_contraction_of_the_casting_holds_its_heat(modulus):
    """Four times the modulus takes twelve times as long, as its gap is four times as wide."""
    steel = find_material("steel-H13", {})
    solidus = find_material("ZnAl4Cu1", {}).solidus
    conductivity = float(steel.description.conductivity.solid(0.5 * (200.0 + solidus)))
    capacity = heat(steel, solidus, 200.0) / (solidus - 200.0)
    die = replace(IN_DIE, conductivity=conductivity, capacity=capacity)
    wall = wall_of(0.011, 0.0075)
    plan = plan_of(casting_process("high-pressure-die"), "ZnAl4Cu1", None, modulus, wall)
    found = die.cooled(modulus, 0.011, 0.0075, solidus)
    assert plan.freezing == pytest.approx(found, rel=0.08)
    assert plan.release == pytest.approx(3.0 * plan.freezing, rel=0.05)


def test_a_die_that_takes_all_heat_grows_warm():
    """A thin one, that hardly loses any, holds back its casting; in a thick one it freezes soon."""
    die = casting_process("gravity-die")
    thin, thick = (plan_of(die, None, None, 0.008, ShellSize(at, 1.0)) for at in (0.012, 0.1))
    assert thin.freezing > 1.3 * thick.freezing
    assert plan_of(die, None, None, 0.008).freezing == pytest.approx(thick.freezing, rel=0.05)


def test_all_interfaces_of_moulds_are_known_by_contact_gas_and_radiation():
    for process in map(casting_process, process_names()):
        for name in process.interfaces.values():
            given = interface_entry(name).heat
            assert given["law"] == "series"
            assert {"closed", "gas_conductivity", "radiation"} <= set(given)


PLUG = """
[geometry]
generator = "cylinder_in_mould"
model = "axisymmetric"
radius = "11 mm"
height = "15 mm"
floor = "7.5 mm"
wall = "7.5 mm"
size = "4 mm"
interface_size = "2 mm"
cells = "quadrilaterals"

[[bodies]]
name = "casting"
material = "ZnAl4Cu1"
temperature = 425
law = "thermo-elasto-viscoplastic"

[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 200
law = "thermo-elastic"

[[interfaces]]
bodies = ["casting", "mould"]
heat = { from = "zinc-steel-high-pressure" }

[[boundaries]]
on = "mould/outside"
heat = { type = "convection", coefficient = 1500, ambient = 150 }

[[boundaries]]
on = "mould/base"
heat = { type = "convection", coefficient = 1500, ambient = 150 }
displacement = { normal = 0 }

[time]
end = 32
largest_step = 1.5
first_step = 0.02
"""


@pytest.mark.slow
def test_half_a_thick_plug_of_zinc_freezes_as_foretold(tmp_path):
    """Within a factor of 1.6; two for the gap, whatever the size, foretold a third of it."""
    area = 0.011**2 + 2.0 * 0.011 * 0.015
    outer, height = 0.011 + 0.0075, 0.015 + 0.0075
    volume = outer**2 * height - 0.011**2 * 0.015
    die = ShellSize(volume / area, (outer**2 + 2.0 * outer * height) / area)
    modulus = 0.011**2 * 0.015 / area
    plan = plan_of(casting_process("high-pressure-die"), "ZnAl4Cu1", None, modulus, die)
    (tmp_path / "plug.toml").write_text(PLUG)
    folder = castx.run(tmp_path / "plug.toml", output=tmp_path / "results")
    rows = list(csv.DictReader((folder / "history.csv").open()))
    frozen = [float(row["time"]) for row in rows if float(row["casting.solid_fraction"]) > 0.99]
    assert 1.0 / 1.6 < frozen[0] / plan.freezing < 1.6


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
