"""Numbers with units."""

import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from castx.errors import CaseError
from castx.input import units
from castx.input.units import converted, number

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    "value, dimension, expected",
    [
        (0.03, units.LENGTH, 0.03),
        (3, units.LENGTH, 3.0),
        ("30 mm", units.LENGTH, 0.03),
        ("30mm", units.LENGTH, 0.03),
        ("-1.5e-2 m", units.LENGTH, -0.015),
        ("1 inch", units.LENGTH, 0.0254),
        ("5 min", units.TIME, 300.0),
        ("2 h", units.TIME, 7200.0),
        ("1e-4 s", units.TIME, 1e-4),
        ("670 degC", units.TEMPERATURE, 670.0),
        ("670 °C", units.TEMPERATURE, 670.0),
        ("943.15 K", units.TEMPERATURE, 670.0),
        ("212 degF", units.TEMPERATURE, 100.0),
        (-273.15, units.TEMPERATURE, -273.15),
        ("0 K", units.TEMPERATURE, -273.15),
        ("20 K", units.TEMPERATURE_DIFFERENCE, 20.0),
        ("20 degC", units.TEMPERATURE_DIFFERENCE, 20.0),
        ("36 degF", units.TEMPERATURE_DIFFERENCE, 20.0),
        ("36 delta_degF", units.TEMPERATURE_DIFFERENCE, 20.0),
        ("2300 W/m^2/K", units.HEAT_TRANSFER, 2300.0),
        ("2300 W/(m^2 K)", units.HEAT_TRANSFER, 2300.0),
        ("2.3 kW/m²/°C", units.HEAT_TRANSFER, 2300.0),
        ("0.237 W/mm/K", units.CONDUCTIVITY, 237.0),
        ("1.08 J/g/K", units.HEAT_CAPACITY, 1080.0),
        ("397 kJ/kg", units.LATENT_HEAT, 397e3),
        ("70 GPa", units.STRESS, 70e9),
        ("70 kN/mm**2", units.STRESS, 70e9),
        ("1 bar", units.STRESS, 1e5),
        ("2.7 g/cm^3", units.DENSITY, 2700.0),
        ("24e-6 1/K", units.EXPANSION, 24e-6),
        ("24e-6 /K", units.EXPANSION, 24e-6),
        ("24 um/m/K", units.EXPANSION, 24e-6),
        ("24 μm/m/K", units.EXPANSION, 24e-6),
        ("1 MPa*s", units.VISCOSITY, 1e6),
        ("1 MPa s", units.VISCOSITY, 1e6),
        ("9.81 m/s^2", units.ACCELERATION, 9.81),
        ("0.6 cm^2*K/W", units.THERMAL_RESISTANCE, 0.6e-4),
        ("33 %", units.PURE_NUMBER, 0.33),
    ],
)
def test_value_in_si(value, dimension, expected):
    assert number(value, dimension) == pytest.approx(expected, rel=1e-12, abs=1e-11)


@pytest.mark.parametrize(
    "value, dimension, text",
    [
        ("90 m", units.TIME, "'m' is not a unit of time; a time is needed in s"),
        ("30 K", units.LENGTH, "'K' is not a unit of length; a length is needed in m"),
        ("670 C", units.TEMPERATURE, "'C' is not a unit of temperature"),
        ("5 delta_degC", units.TEMPERATURE, "not a unit of temperature"),
        ("1 J/kg", units.HEAT_CAPACITY, "a heat capacity per mass is needed in J/kg/K"),
        ("30 mmm", units.LENGTH, "unknown unit 'mmm'; a length is needed in m.*did you mean 'mm'"),
        ("3 m3", units.LENGTH, "unknown unit 'm3'"),
        ("3 m)(m", units.LENGTH, "unknown unit"),
        ("9 m^9^9^9^9", units.LENGTH, "unknown unit"),
        ("1 __import__('os')", units.TIME, "unknown unit"),
        ("1 s.__class__", units.TIME, "unknown unit"),
        ("30", units.LENGTH, "a number in quotes needs a unit: write it without quotes in m"),
        ("", units.LENGTH, "a length is needed: a number in m, or a string with a unit such as mm"),
        ("thirty mm", units.LENGTH, "a length is needed"),
        ("nan mm", units.LENGTH, "a length is needed"),
        ("1 " + "m" * 100, units.LENGTH, "a length is needed"),
        ("1e999 m", units.LENGTH, "must be finite"),
        (10**400, units.LENGTH, "must be finite"),
        (math.nan, units.TIME, "a time must be finite"),
        (-math.inf, units.TIME, "a time must be finite"),
        (True, units.PURE_NUMBER, "a number without unit is needed"),
        (None, units.TIME, "a time is needed"),
        ([1.0], units.TIME, "a time is needed"),
        (-300, units.TEMPERATURE, "below absolute zero, -273.15 °C"),
        ("-1 K", units.TEMPERATURE, "below absolute zero"),
    ],
)
def test_refused_value(value, dimension, text):
    with pytest.raises(CaseError, match=text):
        number(value, dimension)


def test_every_named_unit_belongs_to_its_dimension():
    dimensions = [item for item in vars(units).values() if isinstance(item, units.Dimension)]
    assert len(dimensions) > 15
    for dimension in dimensions:
        for unit in dimension.units:
            assert math.isfinite(number(f"300 {unit}", dimension))


FACTORS = {
    (units.LENGTH, "mm"): 1e-3,
    (units.STRESS, "GPa"): 1e9,
    (units.TIME, "min"): 60.0,
    (units.HEAT_TRANSFER, "kW/m^2/K"): 1e3,
    (units.TEMPERATURE_DIFFERENCE, "degC"): 1.0,
}


@settings(max_examples=60, deadline=None, derandomize=True, database=None)
@given(st.floats(-1e12, 1e12), st.sampled_from(list(FACTORS)))
def test_round_trip(amount, kind):
    dimension, unit = kind
    expected = amount * FACTORS[kind]
    assert number(f"{amount!r} {unit}", dimension) == pytest.approx(expected, rel=1e-12, abs=1e-300)
    assert number(amount, dimension) == amount


@settings(max_examples=60, deadline=None, derandomize=True, database=None)
@given(st.floats(-273.15, 5000.0))
def test_kelvin_and_celsius_agree(celsius):
    kelvin = celsius + 273.15
    assert number(f"{kelvin!r} K", units.TEMPERATURE) == pytest.approx(celsius, abs=1e-9)


@settings(max_examples=200, deadline=None, derandomize=True, database=None)
@given(st.text(max_size=90))
def test_any_text_is_read_or_refused(text):
    try:
        assert math.isfinite(number(text, units.LENGTH))
    except CaseError as error:
        assert "mm, cm, m" in str(error)


@pytest.mark.parametrize(
    ("text", "dimension"),
    [
        ("20 kdegC", units.TEMPERATURE),
        ("20 degC^2/K", units.TEMPERATURE),
        ("700 degRe", units.TEMPERATURE_DIFFERENCE),
        ("20 mdegF", units.TEMPERATURE_DIFFERENCE),
        ("20 dBW^2", units.TIME),
        ("20 dBm/s", units.TIME),
        ("20 dB", units.PURE_NUMBER),
        ("20 Np", units.PURE_NUMBER),
    ],
)
def test_scales_with_an_origin_of_their_own_and_logarithms_are_refused(text, dimension):
    with pytest.raises(CaseError, match=r"unknown unit|is not a unit of"):
        number(text, dimension)


def test_temperatures_end_where_metals_are_vapour():
    assert number(units.HOTTEST, units.TEMPERATURE) == units.HOTTEST
    for value in (1e30, "1e30 K", "20000 degC"):
        with pytest.raises(CaseError, match="above 10000 °C, where every metal is vapour"):
            number(value, units.TEMPERATURE)
    assert number(1e30, units.TEMPERATURE_DIFFERENCE) == 1e30


@pytest.mark.parametrize(
    ("amount", "unit", "wanted", "found"),
    [
        (2.5, "mm", "m", 2.5e-3), (3.0, "W/m²/K", "W/cm^2/K", 3e-4), (20.0, "°C", "K", 293.15),
        (300.0, "K", "°C", 26.85), (4.0, "", "", 4.0), (7.0, "µm", "mm", 7e-3),
    ],
)  # fmt: skip
def test_numbers_are_converted_between_units_of_a_kind(amount, unit, wanted, found):
    assert converted(amount, unit, wanted) == pytest.approx(found, rel=1e-12)


@pytest.mark.parametrize(("unit", "wanted"), [("mm", "s"), ("mm", "°C"), ("cubit", "m")])
def test_numbers_of_another_kind_are_not_converted(unit, wanted):
    with pytest.raises(CaseError, match=unit):
        converted(1.0, unit, wanted)


COMMON = [(unit, text) for unit, factors in units.FACTORS.items() for text in factors]
DIMENSIONS = [found for found in vars(units).values() if isinstance(found, units.Dimension)]


@pytest.mark.parametrize("unit, text", COMMON)
def test_a_common_unit_is_to_the_last_digit_what_pint_makes_of_it(unit, text):
    draws = np.random.default_rng(1).uniform(-1.0, 1.0, 20) * 10.0 ** np.arange(-10.0, 10.0)
    kinds = [dimension for dimension in DIMENSIONS if dimension.unit == unit]
    assert kinds
    for dimension in kinds:
        for x in draws:
            found = units._in_si(float(x), text, dimension)
            assert found == units._by_pint(float(x), text, dimension)


def test_all_units_that_messages_name_are_known_without_pint():
    """But for temperatures with another origin."""
    named = {(d.unit, text) for d in DIMENSIONS for text in d.units}
    assert named - set(COMMON) == {("degC", "K"), ("degC", "degF")}


def test_common_units_do_not_load_pint():
    code = (
        "import sys; from castx.input.units import LENGTH, STRESS, number; "
        "print(number('3 mm', LENGTH), number('2 MPa', STRESS), 'pint' in sys.modules)"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.split() == ["0.003", "2000000.0", "False"]


@pytest.mark.parametrize(
    ("time", "text"),
    [(0.0, "0 s"), (0.12345, "0.1235 s"), (88.566, "88.57 s"), (28800.4, "28800 s"),
     (-12345.6, "-12346 s"), (1e-9, "1e-09 s"), (3e12, "3e+12 s")],
)  # fmt: skip
def test_times_are_shown_without_powers_of_ten(time, text):
    assert units.seconds_text(time) == text
    assert units.seconds_text(1920.4, 3) == "1920 s"
    assert units.plain_text(19724.8, 6) == "19724.8"
    assert [units.plain_text(x, 2) for x in (99.4, 99.6, 150.2)] == ["99", "100", "150"]
