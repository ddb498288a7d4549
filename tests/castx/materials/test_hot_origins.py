"""Numbers of hot solids beside what sources of metals akin to them give."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.database import database_value

pytestmark = pytest.mark.serial

# EN 1993-1-2:2005, table 3.1: what structural steel keeps of its effective yield strength.
KEPT = ([20.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0, 1000.0, 1100.0, 1200.0],
        [1.0, 1.0, 0.78, 0.47, 0.23, 0.11, 0.06, 0.04, 0.02, 0.0])  # fmt: skip


@pytest.mark.parametrize(
    ("name", "key", "ends"),
    [
        ("GJL-250", "yield_stress", {1000.0: (0.89, 1.11), 1125.0: (1.0, 1.22)}),
        (
            "GJL-250",
            "tensile_strength",
            {700.0: (0.89, 1.0), 1000.0: (1.0, 1.2), 1125.0: (1.0, 1.34)},
        ),
        ("GJS-400", "yield_stress", {200.0: (0.9, 1.0), 700.0: (0.66, 0.76), 1115.0: (0.8, 1.0)}),
        (
            "GJS-400",
            "tensile_strength",
            {400.0: (0.8, 1.0), 700.0: (0.7, 0.8), 1115.0: (0.86, 1.14)},
        ),
    ],
)
def test_irons_soften_as_structural_steel(name, key, ends) -> None:
    rows = dict(database_value(name, [key]))
    for at, value in rows.items():
        low, high = next(span for end, span in ends.items() if at <= end)
        share = value / rows[20] / float(np.interp(at, *KEPT))
        assert low - 1e-9 <= share <= high + 1e-9, (at, share)


@pytest.mark.parametrize(
    ("name", "above", "within"), [("GJL-250", 20.0, 0.18), ("GJS-400", 500.0, 0.03)]
)
def test_irons_conduct_as_carbon_steel(name, above, within) -> None:
    """EN 1993-1-2:2005, 3.4.1.3; ductile iron below it by 18 and 9 % at 300 and 500 °C."""
    rows = dict(database_value(name, ["conductivity", "solid"]))
    for at, value in rows.items():
        if at > above:
            expected = 54.0 - 3.33e-2 * at if at < 800.0 else 27.3
            assert value == pytest.approx(expected, rel=within), at
    if name == "GJS-400":
        below = [1.0 - rows[at] / (54.0 - 3.33e-2 * at) for at in (300, 500)]
        assert below == pytest.approx([0.18, 0.09], abs=5e-3)
    else:
        assert rows[20] == 50.0  # GOST 1412-85, SCh25


def test_aluminium_copper_conducts_after_eurocode_9() -> None:
    """EN 1999-1-2:2007, 3.3.1.3, series 5000 and 7000."""
    for at, value in database_value("AlCu4.5", ["conductivity", "solid"]):
        expected = 140.0 + 0.1 * at
        assert value == pytest.approx(expected, rel=0.06 if at <= 400.0 else 0.16), at


@pytest.mark.parametrize(
    ("name", "resistivity", "ratios"),
    [
        ("AlSi7Mg", 45.7e-9, {25: 1.02, 200: 0.91, 400: 0.83, 557: 0.78}),
        ("AlSi9Cu3", 64e-9, {25: 0.97, 200: 0.89, 400: 0.84, 500: 0.79}),
    ],
)
def test_solid_aluminium_silicon_below_wiedemann_and_franz(name, resistivity, ratios) -> None:
    """Resistivity at 20 °C of the data sheets, and the rise of that of pure aluminium."""
    pure = np.transpose(database_value("Al-pure", ["conductivity", "solid"]))

    def of_pure(at: float) -> float:
        return 2.44e-8 * (at + 273.15) / float(np.interp(at, *pure))

    for at, value in database_value(name, ["conductivity", "solid"]):
        hot = resistivity + of_pure(at) - of_pure(20.0)
        assert value * hot / (2.44e-8 * (at + 273.15)) == pytest.approx(ratios[at], abs=6e-3), at


def test_bronze_keeps_of_its_modulus_what_copper_keeps_as_near_to_melting() -> None:
    solidus = database_value("CuSn12", ["solidus"]) + 273.15
    rows = dict(database_value("CuSn12", ["young_modulus"]))
    for at, value in rows.items():
        kept = value / rows[20] / (1.0 - 0.54 * (at + 273.15 - 300.0) / solidus)
        assert (0.82 if at > 600.0 else 0.99) <= kept <= 1.06, at


def test_hot_work_steel_softens_as_the_sources_have_it() -> None:
    """GOST steels 4Kh5MF1S and 40Kh5MF; structural steel at 600 °C; modulus of tool steel."""
    rows = dict(database_value("steel-H13", ["yield_stress"]))
    between = np.interp(400.0, [300.0, 450.0], [1320.0 / 1470.0, 1050.0 / 1300.0])
    kept = {200: 1340.0 / 1470.0, 400: between, 500: 1000.0 / 1300.0, 600: 0.47}
    below = [1.0 - rows[at] / rows[20] / share for at, share in kept.items()]
    assert below == pytest.approx([0.015, 0.07, 0.13, 0.07], abs=5e-3)
    for at, value in database_value("steel-H13", ["young_modulus"]):
        shear = 1.0 - 0.85 * (at + 273.15 - 300.0) / 1680.0
        assert value == pytest.approx(210e9 * shear, rel=0.07), at


def test_structural_steel_hardens_up_to_two_percent_of_strain() -> None:
    """EN 1993-1-2, table 3.1: k_y of S235, whose yield stress here is its proportional limit."""
    rows = dict(database_value("steel-carbon", ["hardening", "linear"]))
    modulus = dict(database_value("steel-carbon", ["young_modulus"]))
    limit = dict(database_value("steel-carbon", ["yield_stress"]))
    hot = [at for at in rows if at >= 200]
    assert hot == list(range(200, 1101, 100))
    for at in hot:
        strength = float(np.interp(at, *KEPT)) * 235e6
        slope = (strength - limit[at]) / (0.02 - strength / modulus[at])
        assert rows[at] == pytest.approx(slope, rel=5e-3), at
    assert rows[20] == rows[100] == pytest.approx(modulus[20] / 1000.0)
