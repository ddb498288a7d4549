"""The database: form of its files, and numbers that are possible for their class of material."""

from __future__ import annotations

from copy import deepcopy
from typing import Any, NamedTuple

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.sourced import UNKNOWN_SOURCE
from castx.materials.database import (
    database_entry,
    database_names,
    database_value,
    read_entry,
)
from castx.materials.flow import PLASTIC, VISCOPLASTIC, law_problems
from castx.materials.granular import GRANULAR, GranularData, granular_surface
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.materials.phased import Phased
from castx.materials.sources import Spread
from castx.materials.thermal_strain import volumetric_thermal_strain
from castx.tables import Table
from tests.castx.materials.descriptions import table

pytestmark = pytest.mark.serial

Range = tuple[float, float]


class Bounds(NamedTuple):
    """What numbers of a class of materials lie between.

    Args:
        density: [kg/m³].
        heat_capacity: of solid and melt [J/kg/K].
        conductivity: of solid and melt [W/m/K].
        latent_heat: [J/kg].
        freezing: solidus and liquidus [°C].
        young_modulus: at 20 °C [Pa].
        contraction: volumetric, from the stress-free temperature to 20 °C.
        yield_stress: at 20 °C [Pa].
    """

    density: Range
    heat_capacity: Range
    conductivity: Range
    latent_heat: Range = (0.0, 0.0)
    freezing: Range = (0.0, 0.0)
    young_modulus: Range = (0.0, 0.0)
    contraction: Range = (0.0, 0.0)
    yield_stress: Range = (0.0, 0.0)


# The peak of steels and irons near 740 °C is the change from ferrite to austenite. Silicon gives
# off 1.79 MJ/kg when it freezes, aluminium 0.4.
BOUNDS = {
    "aluminium": Bounds(
        (2600, 2850), (850, 1300), (50, 245), (3.6e5, 5.8e5), (480, 661),
        (68e9, 76e9), (0.035, 0.060), (10e6, 180e6),
    ),
    "cast iron": Bounds(
        (7000, 7400), (440, 1100), (24, 60), (2.1e5, 2.8e5), (1110, 1250),
        (90e9, 175e9), (0.035, 0.060), (150e6, 320e6),
    ),
    "steel": Bounds(
        (7700, 7900), (420, 5000), (24, 56), (2.4e5, 2.8e5), (1400, 1540),
        (200e9, 215e9), (0.055, 0.075), (230e6, 1500e6),
    ),
    "copper": Bounds(
        (8600, 9000), (350, 560), (40, 405), (1.7e5, 2.15e5), (800, 1085),
        (95e9, 130e9), (0.045, 0.072), (40e6, 200e6),
    ),
    "magnesium": Bounds(
        (1740, 1840), (980, 1420), (45, 105), (3.3e5, 3.8e5), (430, 650),
        (20e9, 47e9), (0.03, 0.067), (4e6, 260e6),
    ),
    "zinc": Bounds(
        (6600, 6850), (390, 550), (40, 115), (1.0e5, 1.3e5), (375, 420),
        (80e9, 100e9), (0.025, 0.04), (150e6, 300e6),
    ),
    # Austenite conducts badly and expands much; pearlite is hard; brass is lighter than bronze.
    "316L": Bounds(
        (7900, 8050), (470, 800), (13, 33), (2.5e5, 2.9e5), (1370, 1460),
        (190e9, 200e9), (0.07, 0.09), (170e6, 300e6),
    ),
    "GJS-600": Bounds(
        (7000, 7400), (440, 1100), (24, 60), (2.1e5, 2.8e5), (1110, 1250),
        (165e9, 180e9), (0.035, 0.060), (350e6, 450e6),
    ),
    "CuZn39Pb1Al": Bounds(
        (8300, 8550), (370, 560), (50, 135), (1.6e5, 2.0e5), (860, 910),
        (95e9, 110e9), (0.045, 0.072), (70e6, 210e6),
    ),
    "sand": Bounds((1450, 2750), (600, 1300), (0.4, 1.2)),
    "coating": Bounds((800, 2500), (700, 1200), (0.1, 1.0)),
    "insulation": Bounds((100, 500), (700, 1300), (0.03, 0.6)),
}  # fmt: skip
PROMISED = {
    "Al-pure", "AlSi7Mg", "AlSi10Mg", "AlSi12", "AlSi9Cu3", "AlCu4.5", "AZ91", "GJL-250",
    "GJS-400", "G20Mn5", "Cu-pure", "steel-H13", "steel-carbon", "sand-silica", "sand-chromite",
    "coating-die", "insulation-fibre", "316L", "ZnAl4Cu1", "CuZn39Pb1Al", "CuSn12", "GJS-600",
}  # fmt: skip
MELTING = [name for name in database_names() if find_material(name, {}).melts]
SANDS = [name for name in database_names() if database_entry(name).material_class == "sand"]
METALS = [
    name
    for name in set(database_names()) - set(SANDS)
    if find_material(name, {}).young_modulus is not None
]
METALS.sort()


def bounds_of(name: str) -> Bounds:
    """Return the bounds of a material where it has its own, or of its class."""
    return BOUNDS.get(name) or BOUNDS[database_entry(name).material_class]


def within(values: Any, bounds: Range) -> bool:
    values = np.asarray(values, dtype=np.float64)
    return bool(((bounds[0] <= values) & (values <= bounds[1])).all())


def valid_of(material: Material, name: str) -> Range:
    (valid,) = (item.valid for item in material.properties() if item.name == name)
    assert valid is not None
    return valid


def elastic_range(material: Material, points: int = 200) -> FloatArray:
    return np.asarray(np.linspace(*valid_of(material, "young_modulus"), points), np.float64)


def test_the_promised_entries_are_there() -> None:
    assert set(database_names()) >= PROMISED
    assert len(database_names()) >= 12


@pytest.mark.parametrize("name", database_names())
def test_every_property_has_unit_source_and_range(name) -> None:
    material = find_material(name, {})
    assert database_entry(name).summary and database_entry(name).material_class in BOUNDS
    for item in material.properties():
        assert item.source not in ("", "case file", "default of castx"), item
        assert "TODO" not in item.source
        varies = isinstance(item.value, Table) and not item.name.startswith("liquid.")
        if varies or item.name.endswith((".solid", ".liquid")):
            assert item.valid is not None and item.valid[0] < item.valid[1], item.name
        if isinstance(item.value, Table) and not item.value.is_constant:
            assert item.valid is not None
            low, high = item.value.arguments[0], item.value.arguments[-1]
            # A table may be used a little beyond its rows, not over a third of its range.
            assert (low - item.valid[0]) + (item.valid[1] - high) <= (high - low) / 3.0, item.name


@pytest.mark.parametrize("name", MELTING)
def test_ranges_meet_at_the_freezing_range(name) -> None:
    material = find_material(name, {})
    assert material.solidus is not None and material.liquidus is not None
    assert material.outside_range(20.0, material.liquidus + 100.0) == []
    for item in material.properties():
        if item.valid is not None and item.name.endswith(".liquid"):
            assert item.valid[0] == pytest.approx(material.liquidus), item.name
        elif item.valid is not None:
            assert item.valid == pytest.approx((20.0, material.solidus)), item.name


@pytest.mark.parametrize("name", database_names())
def test_heat(name) -> None:
    material, bounds = find_material(name, {}), bounds_of(name)
    assert within(material.density, bounds.density)
    for phased, limits in (
        (material.heat_capacity, bounds.heat_capacity),
        (material.conductivity, bounds.conductivity),
    ):
        assert within(phased.solid.values, limits) and within(phased.liquid.values, limits)
    cold = material.enthalpy.enthalpy(20.0)
    diffusivity = material.conductivity(20.0, 1.0) * material.enthalpy.temperature_slope(cold)
    assert 1e-7 < diffusivity < 1.3e-4


@pytest.mark.parametrize("name", database_names())
def test_enthalpy_increases_and_is_inverted(name) -> None:
    material = find_material(name, {})
    curve = material.enthalpy
    temperature = np.linspace(-100.0, 1700.0, 1501)
    assert (np.diff(curve.enthalpy(temperature)) > 0.0).all()
    np.testing.assert_allclose(
        curve.temperature(curve.enthalpy(temperature)), temperature, atol=1e-6
    )
    fraction = curve.solid_fraction(curve.enthalpies)
    assert within(fraction, (0.0, 1.0)) and (np.diff(fraction) <= 0.0).all()


@pytest.mark.parametrize("name", MELTING)
def test_freezing(name) -> None:
    material, bounds = find_material(name, {}), bounds_of(name)
    assert material.solidus is not None and material.liquidus is not None
    assert within(material.latent_heat, bounds.latent_heat)
    assert within([material.solidus, material.liquidus], bounds.freezing)
    assert material.liquidus - material.solidus < 200.0
    curve = material.enthalpy
    rise = curve.enthalpy(material.liquidus) - curve.enthalpy(20.0)
    # Sensible heat of a metal up to its melting point is about 1.2 to 5 times its latent heat.
    assert 1.5 < rise / (material.density * material.latent_heat) < 5.5
    assert material.conductivity.liquid(material.liquidus) < 1.1 * material.conductivity.solid(
        material.solidus
    )
    assert material.liquid is not None and 0.5 <= material.liquid.coherency <= 0.99


@pytest.mark.parametrize("name", METALS)
def test_elasticity(name) -> None:
    material, bounds = find_material(name, {}), bounds_of(name)
    assert material.young_modulus is not None and material.poisson_ratio is not None
    assert within(material.young_modulus(20.0), bounds.young_modulus)
    temperature = elastic_range(material)
    young, poisson = material.young_modulus(temperature), material.poisson_ratio(temperature)
    assert (young > 0.0).all() and (np.diff(young) <= 0.0).all() and young[-1] < 0.8 * young[0]
    assert within(poisson, (0.2, 0.4)) and (np.diff(poisson) >= 0.0).all()
    bulk = young / (3.0 * (1.0 - 2.0 * poisson))
    assert (bulk > 2e9).all()


@pytest.mark.parametrize("name", METALS)
def test_thermal_contraction(name) -> None:
    material, bounds = find_material(name, {}), bounds_of(name)
    assert material.expansion is not None and material.expansion_reference == 20.0
    assert within(material.expansion(100.0), (1.0e-5, 2.75e-5))
    if material.melts:
        stress_free = material.stress_free_temperature(0.0)
        assert material.solidus is not None and material.liquidus is not None
        assert material.solidus <= stress_free <= material.liquidus
        assert material.solid_fraction_at(np.array([stress_free - 1e-6]))[0] >= 0.8
        contraction = -volumetric_thermal_strain(material, 20.0, stress_free)
        assert within(contraction, bounds.contraction)
    temperature = np.linspace(*valid_of(material, "expansion"), 300)
    length = material.expansion(temperature) * (temperature - 20.0)
    slope = np.diff(length) / np.diff(temperature)
    # Ferrous metals shrink while they become austenite, between 700 and 870 °C.
    ferrous = database_entry(name).material_class in ("steel", "cast iron")
    changing = ferrous & (temperature[1:] > 700.0) & (temperature[:-1] < 870.0)
    assert within(slope[~changing], (9e-6, 4.5e-5))


@pytest.mark.parametrize("name", METALS)
def test_strength(name) -> None:
    material, bounds = find_material(name, {}), bounds_of(name)
    description = material.description
    assert description.yield_stress is not None and description.hardening.acts
    assert list(law_problems(description, PLASTIC)) == []
    temperature = elastic_range(material)
    strength = description.yield_stress(temperature)
    assert within(strength[0], bounds.yield_stress)
    assert (np.diff(strength) <= 0.0).all() and (strength > 0.0).all()
    assert material.young_modulus is not None
    # A metal yields at elastic strains below 1 %.
    assert (strength / material.young_modulus(temperature) < 0.01).all()
    linear = table(description.hardening, "linear")(temperature)
    # The curves of EN 1993-1-2 rise by 7 % of E between limit and 2 % of strain at 700 °C.
    assert (linear < 0.08 * material.young_modulus(temperature)).all()


@pytest.mark.parametrize("name", MELTING)
def test_creep(name) -> None:
    """Stress that flows at 1e-4/s: little near melting, the yield stress when cold."""
    material = find_material(name, {})
    description = material.description
    assert list(law_problems(description, VISCOPLASTIC)) == []
    assert description.law == "perzyna"
    assert description.yield_stress is not None
    temperature = elastic_range(material)
    exponent = table(description, "exponent")(temperature)
    assert within(exponent, (3.0, 8.0))

    def flow_stress(rate: float) -> FloatArray:
        assert description.yield_stress is not None
        over = table(description, "viscosity")(temperature) * rate ** (1.0 / exponent)
        return np.asarray(description.yield_stress(temperature) + over)

    slow, fast = flow_stress(1e-4), flow_stress(1e-1)
    assert (np.diff(slow) <= 0.0).all()
    assert slow[0] < 1.1 * description.yield_stress(20.0)
    assert 1e5 < slow[-1] < 15e6
    assert (fast < 3e8 + slow).all() and (fast[-1] > 1.5 * slow[-1])


def test_aluminium_is_isothermal_with_the_heats_of_the_janaf_tables() -> None:
    aluminium = find_material("Al-pure", {})
    assert aluminium.solidus == aluminium.liquidus == pytest.approx(660.3, abs=0.1)
    # H(660.32 °C, liquid) - H(25 °C): 28.69 kJ/mol in the NIST-JANAF tables, 26.98 g/mol
    rise = aluminium.enthalpy.enthalpy(660.323) - aluminium.enthalpy.enthalpy(25.0)
    assert rise / aluminium.density == pytest.approx(28.69e3 / 26.9815e-3, rel=2e-3)


def test_carbon_steel_follows_its_standard() -> None:
    """EN 1993-1-2:2005, 3.4.1: heat to a temperature, conductivity and elongation."""
    steel = find_material("steel-carbon", {})

    def capacity(T: FloatArray) -> FloatArray:
        low = 425 + 0.773 * T - 1.69e-3 * T**2 + 2.22e-6 * T**3
        with np.errstate(divide="ignore"):
            rise, fall = 666 + 13002 / (738 - T), 545 + 17820 / (T - 731)
        return np.select([T < 600, T < 735, T < 900], [low, rise, fall], 650.0)

    T = np.arange(20.0, 1200.005, 0.01, dtype=np.float64)
    c = capacity(T)
    heat = np.cumsum(np.append(0.0, 0.005 * (c[1:] + c[:-1])))
    for at in (300.0, 600.0, 900.0, 1200.0):
        found = (steel.enthalpy.enthalpy(at) - steel.enthalpy.enthalpy(20.0)) / steel.density
        assert found == pytest.approx(np.interp(at, T, heat), rel=0.01)
    assert steel.conductivity.solid(400.0) == pytest.approx(54 - 0.0333 * 400.0, rel=2e-3)
    assert steel.expansion is not None
    for at, elongation in ((500.0, 1.2e-5 * 500 + 4e-9 * 500**2 - 2.416e-4), (800.0, 1.1e-2),
                           (1150.0, 2e-5 * 1150 - 6.2e-3)):  # fmt: skip
        assert steel.expansion(at) * (at - 20.0) == pytest.approx(elongation, rel=0.02)


def test_an_extended_entry_keeps_what_it_does_not_override() -> None:
    """The keys of flow too: another law drops the numbers of the old one."""

    def extended(**changes) -> Material:
        described = type(base.description).read({"extends": "AlSi7Mg", **changes})
        return find_material("own", {"own": described})

    base = find_material("AlSi7Mg", {})
    own = extended(yield_stress=[[20, "120 MPa"], [557, "2 MPa"]], hardening=1e8, stress_free=560)
    assert own.description.yield_stress is not None
    assert own.description.yield_stress(20.0) == 120e6
    assert table(own.description.hardening, "linear")(300.0) == 1e8
    assert not table(own.description.hardening, "saturation").values.any()
    assert table(own.description, "viscosity") is table(base.description, "viscosity")
    assert own.stress_free_temperature(700.0) == 560.0
    sources = {item.name: item.source for item in own.properties()}
    assert sources["yield_stress"] == sources["hardening.linear"] == "case file"
    assert sources["viscosity"] == UNKNOWN_SOURCE

    creeping = extended(law="norton", coefficient=1e-36, exponent=5, activation_energy=150e3)
    assert "viscosity" not in creeping.description.model_fields_set
    assert list(law_problems(creeping.description, VISCOPLASTIC)) == []
    assert creeping.description.yield_stress is base.description.yield_stress

    assert base.liquid is not None
    assert extended(liquid="none").liquid is None
    other = extended(liquid={"viscosity": 1e4, "coherency": 0.6}).liquid
    assert other is not None and other.coherency == 0.6
    moving = extended(kinematic_hardening=1e9).description
    assert table(moving, "kinematic_hardening")(20.0) == 1e9
    with pytest.raises(CaseError, match=r'own.viscosity: acts only with law = "perzyna"'):
        extended(law="norton", coefficient=1e-36, viscosity=1e8)


ENTRY: dict[str, Any] = {
    "summary": "a metal",
    "class": "aluminium",
    "density": {"value": 2700, "unit": "kg/m³", "source": "somebody (1999), table 1"},
    "conductivity": {
        "value": [[20, 200], [500, 180]], "unit": "W/m/K", "source": "x", "valid": [20, 500],
    },
    "poisson_ratio": {"value": 0.33, "source": "x"},
}  # fmt: skip


def test_a_range_of_a_number_and_factors_of_a_table() -> None:
    content = deepcopy(ENTRY)
    content["density"] |= {"range": [2650, 2750], "range_source": "table 2"}
    content["conductivity"] |= {"factors": [0.9, 1.2], "range_source": "estimated"}
    sources = read_entry(content, "a.toml").sources
    assert sources["density"].spread == Spread(2650.0, 2750.0, False, "table 2")
    assert sources["conductivity"].spread == Spread(0.9, 1.2, True, "estimated")
    assert sources["poisson_ratio"].spread is None


@pytest.mark.parametrize(
    ("name", "given", "message"),
    [
        ("density", {"range": [2710, 2750]}, r"density.range = .*: .* with the value between them"),
        ("density", {"range": [2600]}, "two numbers are needed"),
        ("density", {"range": [2600, 2800], "range_source": ""}, "range_source.*: a text"),
        ("density", {"range": [2600, 2800], "factors": [0.9, 1.1]}, "belongs beside one of"),
        ("conductivity", {"range": [100, 300]}, "is of a single number; a table has factors"),
        ("conductivity", {"factors": [1.1, 1.2]}, "with 1 between them"),
    ],
)
def test_ranges_that_are_none_are_refused(name, given, message) -> None:
    content = deepcopy(ENTRY)
    content[name] |= {"range_source": "x", **given}
    with pytest.raises(CaseError, match=message):
        read_entry(content, "a.toml")


def test_values_as_a_case_file_gives_them() -> None:
    assert database_value("AlSi7Mg", ["latent_heat"]) == 389e3
    assert database_value("AlSi7Mg", ["conductivity"])["liquid"] == [[613, 66], [800, 72]]
    assert database_value("AlSi7Mg", ["conductivity", "liquid"]) == [[613, 66], [800, 72]]
    assert database_value("AlSi7Mg", ["summary"]) is None
    assert database_value("AlSi7Mg", ["hardening", "speed"]) is None


def test_an_entry_is_read_with_its_sources() -> None:
    entry = read_entry(ENTRY, "a.toml")
    assert (entry.summary, entry.material_class) == ("a metal", "aluminium")
    assert isinstance(entry.description.conductivity, Phased)
    assert entry.sources["conductivity"].valid == (20.0, 500.0)
    assert entry.sources["density"].text == "somebody (1999), table 1"


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("summary",), "", r"a.toml: summary = \"\": missing; a text"),
        (("class",), None, r"class: missing"),
        (("density",), 2700, r"density = 2700: a table is needed: \{ value"),
        (("density", "value"), None, r"density.value: missing"),
        (("density", "source"), None, r"density.source: missing; author, year"),
        (("density", "source"), "", r"density.source = \"\": missing"),
        (("density", "unit"), "g/cm^3", r'density.unit = "g/cm\^3": must be "kg/m³"; convert'),
        (("density", "unit"), None, r'density.unit: must be "kg/m³"'),
        (("density", "spread"), [0, 1], r"density.spread.*: unknown key; known keys: value, unit"),
        (("density", "range"), [2600, 2800], r"density.range_source: belongs beside one of range"),
        (("density", "range_source"), "x", r"density.range_source = \"x\": belongs beside one of"),
        (("poisson_ratio", "unit"), "1", r'poisson_ratio.unit = "1": a pure number has none'),
        (("conductivity", "valid"), None, r"conductivity.valid: missing; the lowest"),
        (("conductivity", "valid"), [500, 20], r"conductivity.valid = .*: two increasing"),
        (("conductivity", "valid"), [20, 400], r"conductivity.value\[1\] = \[500, 180\]: outside"),
        (("density", "value"), -1, r"^a.toml: density = -1: must be positive \(in kg/m\^3\)"),
        (("poisson_ratio", "value"), 0.5, r"poisson_ratio = 0.5: must be at least 0 and below"),
        (
            ("conductivity", "value"),
            [[500, 180], [20, 200]],
            r"conductivity\[1\] = \[20, 200\]: the first column must increase",
        ),
        (("young_modulus",), {"value": 0, "unit": "Pa", "source": "x"}, r"young_modulus = 0: must"),
        (("modulus",), {"value": 0, "source": "x"}, r"modulus.*: unknown key"),
    ],
)
def test_refused_entries_name_file_key_value_and_cure(path, value, message) -> None:
    content = deepcopy(ENTRY)
    place = content
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    if value is None:
        del place[path[-1]]
    with pytest.raises(CaseError, match=message):
        read_entry(content, "a.toml")


def test_all_problems_of_an_entry_are_shown_together() -> None:
    content = deepcopy(ENTRY)
    del content["density"]["source"], content["conductivity"]["unit"]
    with pytest.raises(CaseError, match=r"a.toml: 2 problems\n  density.source.*\n  conductivity"):
        read_entry(content, "a.toml")


@pytest.mark.parametrize("name", MELTING)
def test_what_freezes_shrinks_and_cast_iron_swells(name) -> None:
    shrinkage = find_material(name, {}).description.solidification_shrinkage
    iron = name.startswith("GJ")
    assert within([shrinkage], (-0.03, -0.003) if iron else (0.02, 0.075))


@pytest.mark.parametrize("name", SANDS)
def test_sand_yields_and_loses_its_strength_where_it_burns(name) -> None:
    material = find_material(name, {})
    assert list(law_problems(material.description, GRANULAR)) == []
    granular = material.description.granular
    assert isinstance(granular, GranularData) and granular.tension_cut_off is not None
    temperature = np.asarray(np.linspace(20.0, 1300.0, 50), np.float64)
    surface = granular_surface(granular, temperature)
    for strength in (surface.strength, surface.cut_off):
        assert (np.diff(strength) <= 0).all() and 0 < strength[-1] < 0.1 * strength[0]
    # Crushed at some MPa, far below any metal, and torn at less.
    angle = np.radians(granular.friction_angle)
    crushed = 2 * granular.cohesion(20.0) * np.cos(angle) / (1 - np.sin(angle))
    assert within(crushed, (1e6, 6e6)) and 3 * surface.cut_off[0] < crushed
    assert material.expansion is not None and material.expansion_reference == 20.0
    # Silica grows by its change at 573 °C, chromite by less than half of that.
    growth = material.expansion(590.0) * 570
    assert within(growth, (0.014, 0.016) if name == "sand-silica" else (0.001, 0.007))
