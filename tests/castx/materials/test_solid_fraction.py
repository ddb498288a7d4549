"""Laws of the solid fraction: values by hand, ends, plateaus, and the balance of solute."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import brentq

from castx.arrays import FloatArray
from castx.materials.lookup import find_material
from castx.materials.solid_fraction import (
    LeverLaw,
    LinearLaw,
    Plateau,
    ScheilLaw,
    SolidFractionLaw,
    TabulatedLaw,
    fraction_at,
    plateaus,
    temperature_at,
)

pytestmark = pytest.mark.serial

SOLIDUS, LIQUIDUS, MELTING_POINT, PARTITION = 540.0, 610.0, 660.0, 0.15
TABLE = TabulatedLaw(((540.0, 1.0), (577.0, 0.7), (577.0, 0.4), (610.0, 0.0)))
LAWS: dict[str, SolidFractionLaw] = {
    "linear": LinearLaw(),
    "lever": LeverLaw(PARTITION, MELTING_POINT),
    "lever, solid early": LeverLaw(0.8, MELTING_POINT),
    "scheil": ScheilLaw(PARTITION, MELTING_POINT),
    "table": TABLE,
}


def at(law: SolidFractionLaw, *temperature: float) -> FloatArray:
    return fraction_at(law, SOLIDUS, LIQUIDUS, np.array(temperature))


@pytest.mark.parametrize("name", LAWS)
def test_the_fraction_falls_from_one_to_zero(name) -> None:
    law = LAWS[name]
    temperature = np.linspace(SOLIDUS - 50.0, LIQUIDUS + 50.0, 501, dtype=np.float64)
    fraction = fraction_at(law, SOLIDUS, LIQUIDUS, temperature)
    assert (fraction[temperature < SOLIDUS] == 1.0).all()
    assert (fraction[temperature >= LIQUIDUS] == 0.0).all()
    assert (np.diff(fraction) <= 1e-14).all()
    pieces = law.pieces(SOLIDUS, LIQUIDUS)
    assert (pieces[0].start, pieces[-1].end) == (SOLIDUS, LIQUIDUS)
    assert all(a.end == b.start for a, b in pairwise(pieces))


def test_values_by_hand() -> None:
    np.testing.assert_allclose(at(LAWS["linear"], 557.5), 0.75)
    # A table with a plateau: straight lines beside it, at its temperature the liquid side.
    np.testing.assert_allclose(at(TABLE, 558.5, 577.0, 593.5), [0.85, 0.4, 0.2], rtol=1e-12)


def test_plateaus_are_the_jumps_of_a_law_the_coldest_first() -> None:
    assert plateaus(LAWS["linear"], SOLIDUS, LIQUIDUS) == ()
    assert plateaus(LinearLaw(), 600.0, 600.0) == (Plateau(600.0, 0.0, 1.0),)
    (eutectic,) = plateaus(LAWS["scheil"], SOLIDUS, LIQUIDUS)
    assert (eutectic.temperature, eutectic.end) == (SOLIDUS, 1.0)
    assert eutectic.begin == pytest.approx(at(LAWS["scheil"], SOLIDUS + 1e-9)[0])
    rows = ((540.0, 1.0), (540.0, 0.9), (577.0, 0.7), (577.0, 0.4), (610.0, 0.1), (610.0, 0.0))
    found = plateaus(TabulatedLaw(rows), 540.0, 610.0)
    assert [plateau.temperature for plateau in found] == [540.0, 577.0, 610.0]
    ends = [value for plateau in found for value in (plateau.begin, plateau.end)]
    np.testing.assert_allclose(ends, [0.9, 1.0, 0.4, 0.7, 0.0, 0.1], atol=1e-15)


@pytest.mark.parametrize("name", LAWS)
def test_a_fraction_is_reached_at_the_highest_temperature_that_has_it(name) -> None:
    law = LAWS[name]
    for fraction in (1.0, 0.95, 0.6, 0.4, 0.1):
        found = temperature_at(law, SOLIDUS, LIQUIDUS, fraction)
        below, above = at(law, found - 1e-6, found + 1e-6)
        assert below >= fraction > above
    assert temperature_at(law, SOLIDUS, LIQUIDUS, 0.0) == LIQUIDUS
    assert temperature_at(LinearLaw(), 600.0, 600.0, 0.5) == 600.0


@pytest.mark.parametrize("name", LAWS)
def test_the_temperature_of_a_fraction_is_the_root_of_the_law(name) -> None:
    law, highest = LAWS[name], max(piece.fraction(np.array([piece.start]))[0]
                                   for piece in LAWS[name].pieces(SOLIDUS, LIQUIDUS))  # fmt: skip
    for fraction in np.linspace(0.01, 0.999 * highest, 57):
        if name == "table" and 0.4 <= fraction <= 0.7:
            continue  # its plateau has all of them
        root = brentq(lambda T, f=fraction: f - at(law, T)[0], SOLIDUS, LIQUIDUS, xtol=1e-12)
        assert temperature_at(law, SOLIDUS, LIQUIDUS, fraction) == pytest.approx(root, abs=1e-9)


def test_all_is_solid_at_the_solidus_where_rounding_says_so_before() -> None:
    law = ScheilLaw(0.98, MELTING_POINT)
    assert at(law, SOLIDUS)[0] == 1.0
    assert temperature_at(law, SOLIDUS, LIQUIDUS, 1.0) == SOLIDUS
    assert SOLIDUS < temperature_at(law, SOLIDUS, LIQUIDUS, 1.0 - 1e-9) < LIQUIDUS


def test_solute_is_balanced_in_equilibrium() -> None:
    """C_0 = f_s k C_l + (1 − f_s) C_l with C_l in proportion to T_m − T."""
    temperature = np.array([560.0, 590.0, 609.0])
    fraction = at(LAWS["lever"], *temperature)
    liquid = (MELTING_POINT - temperature) / (MELTING_POINT - LIQUIDUS)
    np.testing.assert_allclose(fraction * PARTITION * liquid + (1 - fraction) * liquid, 1.0)
    # A solid without eutectic ends at its equilibrium solidus, T_m − (T_m − T_l)/k = 597.5 °C.
    ends = at(LAWS["lever, solid early"], 597.4, 597.6)
    np.testing.assert_allclose(ends, [1.0, 12.4 / (0.2 * 62.4)], rtol=1e-12)


def test_solute_is_balanced_without_diffusion_in_the_solid() -> None:
    """Gulliver and Scheil: (1 − k) C_l df_s = (1 − f_s) dC_l."""
    temperature, h = np.array([560.0, 590.0, 605.0]), 1e-3
    law = LAWS["scheil"]
    slope = (at(law, *(temperature + h)) - at(law, *(temperature - h))) / (2 * h)
    depression = MELTING_POINT - temperature
    left = (1 - PARTITION) * depression * -slope
    np.testing.assert_allclose(left, 1 - at(law, *temperature), rtol=1e-6)


def test_an_isothermal_change_has_no_pieces() -> None:
    assert LinearLaw().pieces(600.0, 600.0) == ()
    assert fraction_at(LinearLaw(), 600.0, 600.0, np.array([599.0, 600.0])).tolist() == [1.0, 0.0]


@pytest.mark.parametrize("name", ["Al-pure", "AlSi7Mg", "steel-H13"])
def test_fraction_of_a_temperature_is_that_of_its_enthalpy(name) -> None:
    material = find_material(name, {})
    T = np.linspace(100.0, 800.0, 1401, dtype=np.float64)
    expected = material.enthalpy.solid_fraction(material.enthalpy.enthalpy(T))
    assert np.abs(material.solid_fraction_at(T) - expected).max() < 1e-4
