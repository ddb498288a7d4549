"""Enthalpy curves against closed forms, inversion, plateaus and finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from castx.errors import CaseError
from castx.materials.enthalpy import CURVE_TOLERANCE, EnthalpyCurve, enthalpy_curve
from castx.materials.phased import Phased
from castx.materials.solid_fraction import (
    LeverLaw,
    LinearLaw,
    ScheilLaw,
    SolidFractionLaw,
    TabulatedLaw,
)
from castx.tables import Table

pytestmark = pytest.mark.serial

DENSITY = 2500.0
LATENT = 4e5
SOLIDUS, LIQUIDUS = 550.0, 610.0
SOLID, LIQUID = 1000.0, 1200.0
CONSTANT = Phased(Table.constant(SOLID), Table.constant(LIQUID))
BENT = Phased(
    Table.from_points([(0, 900), (300, 1000), (560, 1180)]),
    Table.from_points([(580, 1150), (900, 1250)]),
)
K, MELTING = 0.13, 660.0
LAWS: dict[str, SolidFractionLaw] = {
    "linear": LinearLaw(),
    "lever": LeverLaw(K, MELTING),
    "scheil": ScheilLaw(K, MELTING),
    "table": TabulatedLaw(((550.0, 0.9), (577.0, 0.7), (577.0, 0.5), (610.0, 0.0))),
}


def melting(
    law: str,
    capacity: Phased = CONSTANT,
    solidus: float = SOLIDUS,
    liquidus: float = LIQUIDUS,
    latent: float = LATENT,
) -> EnthalpyCurve:
    return enthalpy_curve(
        DENSITY, capacity, latent_heat=latent, solidus=solidus, liquidus=liquidus, law=LAWS[law]
    )


def error(curve: EnthalpyCurve, temperature: np.ndarray, exact: np.ndarray) -> float:
    """Largest distance in temperature between the curve and exact enthalpies."""
    return float(np.abs(curve.temperature(exact) - temperature).max())


def test_constant_capacity_without_melting() -> None:
    curve = enthalpy_curve(DENSITY, Phased.uniform(Table.constant(SOLID)))
    temperature = np.linspace(-200.0, 2000.0, 101)
    enthalpy = curve.enthalpy(temperature)
    np.testing.assert_allclose(enthalpy, DENSITY * SOLID * temperature, rtol=1e-13, atol=1e-3)
    assert (curve.solid_fraction(enthalpy) == 1.0).all()
    assert (curve.solid_fraction_slope(enthalpy) == 0.0).all()
    np.testing.assert_allclose(curve.temperature_slope(enthalpy), 1 / (DENSITY * SOLID), rtol=1e-13)


def test_linear_capacity_is_integrated_and_constant_outside_its_table() -> None:
    curve = enthalpy_curve(DENSITY, Phased.uniform(Table.from_points([(100, 900), (500, 1100)])))
    temperature = np.linspace(-300.0, 900.0, 1201)
    inside = np.clip(temperature, 100.0, 500.0)
    exact = DENSITY * (
        900.0 * np.minimum(temperature, 100.0)
        + 900.0 * (inside - 100.0)
        + 0.25 * (inside - 100.0) ** 2
        + 1100.0 * np.maximum(temperature - 500.0, 0.0)
    )
    assert error(curve, temperature, exact) < 1.01 * CURVE_TOLERANCE


def linear_integral(temperature: np.ndarray) -> np.ndarray:
    """∫f_s dT from the solidus for f_s linear."""
    above = temperature - SOLIDUS
    return np.asarray(above - above**2 / (2.0 * (LIQUIDUS - SOLIDUS)))


def scheil_integral(temperature: np.ndarray) -> np.ndarray:
    """∫f_s dT from the solidus for f_s = 1 − r^(−p), r = (T_m − T)/(T_m − T_l), p = 1/(1 − k)."""
    p = 1.0 / (1.0 - K)
    depression = MELTING - LIQUIDUS

    def liquid(at: np.ndarray | float) -> np.ndarray | float:
        return -depression * ((MELTING - at) / depression) ** (1.0 - p) / (1.0 - p)

    return np.asarray(temperature - SOLIDUS - (liquid(temperature) - liquid(SOLIDUS)))


def lever_integral(temperature: np.ndarray) -> np.ndarray:
    """∫f_s dT from the solidus for f_s = (T_l − T)/((1 − k)(T_m − T))."""
    logarithm = np.log((MELTING - temperature) / (MELTING - SOLIDUS))
    return np.asarray((temperature - SOLIDUS + (MELTING - LIQUIDUS) * logarithm) / (1.0 - K))


@pytest.mark.parametrize(
    ("law", "fraction", "integral"),
    [
        ("linear", lambda t: (LIQUIDUS - t) / (LIQUIDUS - SOLIDUS), linear_integral),
        ("lever", lambda t: (LIQUIDUS - t) / ((1 - K) * (MELTING - t)), lever_integral),
        (
            "scheil",
            lambda t: 1 - ((MELTING - t) / (MELTING - LIQUIDUS)) ** (1 / (K - 1)),
            scheil_integral,
        ),
    ],
)
def test_freezing_range_in_closed_form(law, fraction, integral) -> None:
    curve = melting(law)
    temperature = np.linspace(SOLIDUS, LIQUIDUS, 501)
    solid = fraction(temperature)
    exact = DENSITY * (
        SOLID * SOLIDUS
        + LIQUID * (temperature - SOLIDUS)
        + (SOLID - LIQUID) * integral(temperature)
        + LATENT * (1.0 - solid)
    )
    enthalpy = curve.enthalpy(temperature)
    assert error(curve, temperature, exact) < 1.01 * CURVE_TOLERANCE
    np.testing.assert_allclose(curve.solid_fraction(enthalpy), solid, atol=1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_freezing_releases_the_latent_heat_once(law) -> None:
    equal = enthalpy_curve(
        DENSITY,
        Phased.uniform(Table.constant(SOLID)),
        latent_heat=LATENT,
        solidus=SOLIDUS,
        liquidus=LIQUIDUS,
        law=LAWS[law],
    )
    released = equal.enthalpy(700.0) - equal.enthalpy(500.0)
    assert released == pytest.approx(DENSITY * (SOLID * 200.0 + LATENT), rel=1e-12)


def test_zero_of_the_enthalpy_is_the_solid_at_zero_degrees() -> None:
    assert melting("linear", BENT).enthalpy(0.0) == pytest.approx(0.0, abs=1e-6)
    ice = melting("linear", CONSTANT, solidus=0.0, liquidus=0.0)
    assert ice.enthalpy(0.0) == pytest.approx(DENSITY * LATENT)
    assert ice.enthalpy(-1e-9) == pytest.approx(0.0, abs=0.01)


def test_isothermal_change_is_exact() -> None:
    curve = melting("linear", BENT, solidus=600.0, liquidus=600.0)
    liquid = curve.enthalpy(600.0)
    solid = liquid - DENSITY * LATENT
    enthalpy = solid + np.linspace(0.0, 1.0, 1001)[1:-1] * (liquid - solid)
    assert (curve.temperature(enthalpy) == 600.0).all()
    assert (curve.temperature_slope(enthalpy) == 0.0).all()
    np.testing.assert_allclose(
        curve.solid_fraction(enthalpy), (liquid - enthalpy) / (DENSITY * LATENT), atol=1e-12
    )
    np.testing.assert_allclose(
        curve.solid_fraction_slope(enthalpy), -1.0 / (DENSITY * LATENT), rtol=1e-12
    )
    assert curve.solid_fraction(liquid) == 0.0
    assert curve.enthalpy(600.0 - 1e-9) == pytest.approx(solid, abs=1.0)
    assert curve.temperature_slope(solid - 1.0) > 0.0
    assert curve.temperature_slope(liquid + 1.0) > 0.0


def test_isothermal_change_without_latent_heat_still_melts() -> None:
    curve = melting("linear", solidus=600.0, liquidus=600.0, latent=0.0)
    enthalpy = curve.enthalpy(np.array([599.0, 600.0, 601.0]))
    np.testing.assert_array_equal(curve.solid_fraction(enthalpy), [1.0, 0.0, 0.0])
    np.testing.assert_allclose(curve.temperature(enthalpy), [599.0, 600.0, 601.0])
    assert np.isfinite(curve.temperature_slope(enthalpy)).all()


@pytest.mark.parametrize(("law", "left"), [("scheil", None), ("lever", None), ("table", 0.1)])
def test_eutectic_remainder_freezes_at_the_solidus(law, left) -> None:
    curve = melting(law)
    ratio = (MELTING - SOLIDUS) / (MELTING - LIQUIDUS)
    remainder = {
        "scheil": ratio ** (1 / (K - 1)),
        "lever": 1 - (LIQUIDUS - SOLIDUS) / ((1 - K) * (MELTING - SOLIDUS)),
        "table": left,
    }[law]
    upper = curve.enthalpy(SOLIDUS)
    lower = upper - DENSITY * LATENT * remainder
    inside = lower + np.linspace(0.001, 0.999, 99) * (upper - lower)
    assert (curve.temperature(inside) == SOLIDUS).all()
    assert (curve.temperature_slope(inside) == 0.0).all()
    assert curve.solid_fraction(lower) == pytest.approx(1.0, abs=1e-12)
    assert curve.solid_fraction(upper) == pytest.approx(1.0 - remainder, abs=1e-12)
    assert curve.temperature_slope(lower - 1.0) > 0.0


def test_temperature_given_twice_in_a_table_is_a_plateau() -> None:
    curve = melting("table")
    upper = curve.enthalpy(577.0)
    inside = upper - DENSITY * LATENT * 0.2 * np.linspace(0.01, 0.99, 50)
    assert (curve.temperature(inside) == 577.0).all()
    assert curve.solid_fraction(upper) == pytest.approx(0.5)


def test_lever_rule_is_solid_below_its_equilibrium_solidus() -> None:
    law = LeverLaw(0.5, MELTING)  # equilibrium solidus 560 °C
    curve = enthalpy_curve(
        DENSITY, CONSTANT, latent_heat=LATENT, solidus=SOLIDUS, liquidus=LIQUIDUS, law=law
    )
    temperature = np.array([550.0, 555.0, 559.999, 580.0])
    expected = [1.0, 1.0, 1.0, 30.0 / (0.5 * 80.0)]
    np.testing.assert_allclose(
        curve.solid_fraction(curve.enthalpy(temperature)), expected, atol=1e-4
    )
    assert (np.diff(curve.temperatures) > 0.0).all()


@pytest.mark.parametrize("capacity", [CONSTANT, BENT], ids=["constant", "bent"])
@pytest.mark.parametrize("law", LAWS)
def test_curve_increases_and_extrapolates(law, capacity) -> None:
    curve = melting(law, capacity)
    assert (np.diff(curve.enthalpies) > 0.0).all()
    assert (np.diff(curve.temperatures) >= 0.0).all()
    assert (np.diff(curve.fractions) <= 0.0).all()
    cold, hot = curve.enthalpy(-400.0), curve.enthalpy(3000.0)
    capacity_cold = float(capacity.solid(-400.0))
    capacity_hot = float(capacity.liquid(3000.0))
    assert curve.temperature_slope(cold) == pytest.approx(1 / (DENSITY * capacity_cold))
    assert curve.temperature_slope(hot) == pytest.approx(1 / (DENSITY * capacity_hot))
    assert (curve.solid_fraction(cold), curve.solid_fraction(hot)) == (1.0, 0.0)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    temperature=st.lists(st.floats(-270.0, 3000.0), min_size=1, max_size=20),
    law=st.sampled_from(sorted(LAWS)),
    capacity=st.sampled_from([CONSTANT, BENT]),
)
def test_temperature_of_enthalpy_of_temperature(temperature, law, capacity) -> None:
    curve = melting(law, capacity)
    given_temperature = np.array(temperature)
    found = curve.temperature(curve.enthalpy(given_temperature))
    np.testing.assert_allclose(found, given_temperature, atol=1e-9)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    fraction=st.floats(0.0, 1.0),
    melting_point=st.floats(-50.0, 1500.0),
    width=st.sampled_from([0.0, 1e-6, 0.5, 80.0]),
    latent=st.sampled_from([0.0, 1e3, 4e5]),
)
def test_enthalpy_of_temperature_of_enthalpy(fraction, melting_point, width, latent) -> None:
    curve = melting(
        "linear", BENT, solidus=melting_point, liquidus=melting_point + width, latent=latent
    )
    low, high = curve.enthalpy(melting_point - 100.0), curve.enthalpy(melting_point + 200.0)
    enthalpy = low + fraction * (high - low)
    temperature = curve.temperature(enthalpy)
    assert melting_point - 100.001 < temperature < melting_point + 200.001
    if curve.temperature_slope(enthalpy) > 0.0 and width > 1e-3:
        assert curve.enthalpy(temperature) == pytest.approx(enthalpy, rel=1e-9, abs=1.0)
    assert 0.0 <= curve.solid_fraction(enthalpy) <= 1.0


@pytest.mark.parametrize("law", LAWS)
def test_slopes_agree_with_differences(law) -> None:
    curve = melting(law, BENT)
    middle = 0.5 * (curve.enthalpies[1:] + curve.enthalpies[:-1])
    half = 0.25 * np.diff(curve.enthalpies)
    temperature = (curve.temperature(middle + half) - curve.temperature(middle - half)) / (2 * half)
    fraction = (curve.solid_fraction(middle + half) - curve.solid_fraction(middle - half)) / (
        2 * half
    )
    largest = curve.temperature_slope(middle).max()
    np.testing.assert_allclose(temperature, curve.temperature_slope(middle), atol=1e-6 * largest)
    steepest = np.abs(curve.solid_fraction_slope(middle)).max()
    np.testing.assert_allclose(fraction, curve.solid_fraction_slope(middle), atol=1e-6 * steepest)


def test_curve_stays_small() -> None:
    assert melting("scheil", BENT).temperatures.size < 6000
    assert melting("linear").temperatures.size < 300
    assert enthalpy_curve(DENSITY, Phased.uniform(Table.constant(SOLID))).temperatures.size == 3


def test_an_enthalpy_that_does_not_increase_is_refused() -> None:
    frozen = Table.from_points([(0, 1000), (300, 1000), (320, 1e-30), (600, 1e-30)])
    with pytest.raises(CaseError, match=r"does not increase from .* °C: the heat capacity there"):
        melting("linear", Phased.uniform(frozen))
