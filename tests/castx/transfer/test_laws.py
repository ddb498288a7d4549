"""Laws of the heat transfer at interfaces: values, continuity at closure, derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from castx.case.heat_transfer import InterfaceHeat
from castx.heat.law_building import conduction_law
from castx.transfer.conductance import PRIMARY, SECONDARY, SOLID, Faces
from castx.transfer.laws import SMALLEST_RELATIVE_PRESSURE
from castx.transfer.pair_state import PairState

pytestmark = pytest.mark.serial

PRESSURE = {"resistance": 1.6666667e-5, "hardness": "1.2 GPa", "exponent": 0.95}
LIMITED = {"law": "limited", "closed": 800, "gas_conductivity": 0.04}
SERIES = {**LIMITED, "law": "series"}
ROUGH = {
    "law": "series", "gas_conductivity": 0.04, "roughness": ["30 um", "40 um"],
    "coating": {"thickness": "100 um", "conductivity": 0.5},
}  # fmt: skip
FALLING = {"over": "temperature", "table": [[100, 900], [300, 1500], [600, 600]]}
GAS = {"over": "temperature", "table": [[0, 0.025], [1000, 0.07]]}
BY_GAP = {"over": "gap", "table": [[0, 800], ["100 um", 300], ["1 mm", 40]]}
BY_PRESSURE = {"over": "pressure", "table": [[0, 800], ["10 MPa", 5000]]}


def conductance(heat, gap=0.0, pressure=0.0, secondary=500.0, primary=200.0, time=0.0, solid=0.3):
    """Return the conductance of a law at numbers or arrays of one length."""
    values = np.broadcast_arrays(*(np.atleast_1d(v).astype(float) for v in (gap, pressure)))
    hot, cold = (np.broadcast_to(v, values[0].shape).astype(float) for v in (secondary, primary))
    faces = Faces.at_temperatures(hot, cold, time, solid)
    return conduction_law(InterfaceHeat.read(heat))(PairState.of(*values), faces)


def coefficient(heat, *arguments, **named):
    return conductance(heat, *arguments, **named).coefficient.value


def test_limited_is_the_smaller_of_contact_and_gas():
    # 0.04/100e-6 = 400, 0.04/50e-6 = 800, 0.04/25e-6 = 1600
    h = coefficient(LIMITED, [0.0, 25e-6, 50e-6, 100e-6, 1e-3])
    np.testing.assert_allclose(h, [800.0, 800.0, 800.0, 400.0, 40.0], rtol=1e-12)


def test_series_adds_the_resistances():
    # 1/(1/2000 + 1e-4/0.05) = 400
    heat = {"law": "series", "closed": "2 kW/m^2/K", "gas_conductivity": 0.05}
    np.testing.assert_allclose(coefficient(heat, [0.0, 1e-4]), [2000.0, 400.0])


def test_constant_and_none():
    gaps = np.array([-1e-6, 0.0, 1e-3])
    np.testing.assert_array_equal(coefficient({"law": "constant", "closed": 80}, gaps), [80.0] * 3)
    np.testing.assert_array_equal(coefficient({"law": "none"}, gaps), [0.0] * 3)


def test_closed_contact_of_two_bars():
    # verification V19: h0 + (1/R)(p/H_e)^b at p = 276.472197 MPa
    h = coefficient({**LIMITED, "pressure": PRESSURE}, 0.0, 276.472197e6)
    np.testing.assert_allclose(h, 15676.404, rtol=1e-6)


def test_roughness_and_coating():
    # R_z = ½√(30² + 40²) = 25 µm: R = 25e-6/0.04 + 100e-6/0.5 = 6.25e-4 + 2e-4 = 8.25e-4
    assert coefficient(ROUGH) == pytest.approx(1 / 8.25e-4, rel=1e-12)
    assert coefficient(ROUGH, 40e-6) == pytest.approx(1 / (8.25e-4 + 1e-3), rel=1e-12)
    beside = {**ROUGH, "pressure": {"hardness": 1e9, "exponent": 1.0}}
    assert coefficient(beside, 0.0, 1e8) == pytest.approx(1.1 / 8.25e-4, rel=1e-12)
    given = {**beside, "closed": 900}
    assert coefficient(given, 0.0, 1e8) == pytest.approx(900 + 0.1 / 8.25e-4, rel=1e-12)
    inside = {**LIMITED, "pressure": {**beside["pressure"], "roughness": [30e-6, 40e-6]}}
    assert coefficient(inside, 0.0, 1e8) == pytest.approx(800 + 0.1 / 6.25e-4, rel=1e-12)
    bare = {"law": "constant", "coating": {"thickness": 1e-4, "conductivity": 0.5}}
    assert coefficient(bare, 1.0) == pytest.approx(5000.0)


def test_tables_over_temperature_time_gap_and_pressure():
    heat = {"law": "constant", "closed": FALLING}
    assert coefficient(heat, secondary=200.0, primary=0.0) == pytest.approx(1200.0)
    other = {"law": "constant", "closed": {**FALLING, "of": "primary"}}
    assert coefficient(other, secondary=0.0, primary=450.0) == pytest.approx(1050.0)
    mean = {"law": "constant", "closed": {**FALLING, "of": "mean"}}
    assert coefficient(mean, secondary=300.0, primary=100.0) == pytest.approx(1200.0)
    timed = {"law": "constant", "closed": {"over": "time", "table": [[0, 100], ["1 min", 700]]}}
    assert coefficient(timed, time=30.0) == pytest.approx(400.0)
    assert coefficient({"law": "constant", "closed": BY_GAP}, 50e-6) == pytest.approx(550.0)
    found = coefficient({"law": "constant", "closed": BY_PRESSURE}, 0.0, [0.0, 5e6])
    assert found == pytest.approx([800.0, 2900.0])
    both = {"law": "limited", "closed": BY_PRESSURE, "open": BY_GAP}
    found = coefficient(both, [0.0, 0.0, 50e-6], [5e6, 0.0, 0.0])
    assert found == pytest.approx([2900.0, 800.0, 550.0])


def test_gas_over_the_mean_temperature():
    heat = {**LIMITED, "gas_conductivity": GAS}
    k = 0.025 + 0.045 * 0.35  # at 350 °C
    assert coefficient(heat, 1e-3) == pytest.approx(k / 1e-3)


def test_solid_fraction_law():
    heat = {"law": "solid-fraction", "closed": 2000, "open": 200}
    assert coefficient(heat, solid=0.0) == pytest.approx(2000.0)
    assert coefficient(heat, solid=1.0) == pytest.approx(200.0)
    found = conductance(heat, solid=0.25)
    assert found.coefficient.value == pytest.approx(1550.0)
    assert found.contact == pytest.approx(1500.0 / 1550.0)
    assert found.coefficient.slopes[SOLID] == pytest.approx(-1800.0)


def test_what_passes_where_surfaces_touch_and_what_the_gas_carries():
    np.testing.assert_array_equal(conductance(LIMITED, [0.0, 1e-6, -1e-6]).contact, [1.0, 0.0, 1.0])


@pytest.mark.parametrize("law", ["limited", "series"])
@pytest.mark.parametrize("exponent", [0.5, 0.95, 1.0, 1.5])
@pytest.mark.parametrize("transition", [0.0, 10e-6, 1e-3])
def test_the_law_is_continuous_at_closure_and_monotone(law, exponent, transition):
    heat = {**LIMITED, "law": law, "pressure": {**PRESSURE, "exponent": exponent}}
    heat |= {"transition": transition} if transition else {}
    gaps = np.concatenate([np.linspace(1e-4, 1e-13, 200), np.zeros(200)])
    pressures = np.concatenate([np.zeros(200), np.geomspace(1e-9, 1e9, 200)])
    h = coefficient(heat, gaps, pressures)
    assert (np.diff(h) >= -1e-9).all()
    assert h[199] == pytest.approx(800.0, rel=1e-6) and h[200] == pytest.approx(800.0, rel=1e-6)


CONTINUOUS = [
    LIMITED,
    SERIES,
    ROUGH,
    {**LIMITED, "transition": "10 um"},
    {**SERIES, "transition": "10 um"},
    {"law": "constant", "closed": 800},
    {"law": "constant", "closed": BY_GAP},
    {"law": "limited", "closed": BY_PRESSURE, "open": BY_GAP},
    {"law": "limited", "closed": 500, "open": BY_GAP},
    {"law": "limited", "closed": FALLING, "gas_conductivity": GAS},
    {"law": "series", "closed": BY_PRESSURE, "gas_conductivity": GAS, "transition": "10 um"},
    {"law": "solid-fraction", "closed": FALLING, "open": 100},
]


@pytest.mark.parametrize("heat", CONTINUOUS)
@pytest.mark.parametrize("pressure", [None, {**PRESSURE, "exponent": 0.6}])
def test_every_law_is_continuous_at_closure(heat, pressure):
    if pressure is not None and heat["law"] != "solid-fraction":
        heat = {**heat, "pressure": pressure}
    touching = coefficient(heat)
    assert coefficient(heat, 1e-13) == pytest.approx(touching, rel=1e-5)
    assert coefficient(heat, 0.0, 1e-3) == pytest.approx(touching, rel=1e-5)


@pytest.mark.parametrize("law", ["limited", "series"])
@pytest.mark.parametrize("width", [5e-6, 40e-6, 200e-6])
def test_rounded_laws_have_no_bend(law, width):
    """The slope over the gap is continuous, zero at closure; outside the width nothing changes."""
    sharp, heat = {**LIMITED, "law": law}, {**LIMITED, "law": law, "transition": width}
    bend = 50e-6 if law == "limited" else 0.0  # k/closed, or closure
    low, high = (max(bend - width / 2, 0.0), bend + width / 2) if bend else (0.0, width)
    if low == 0.0 and bend:
        high = 2 * bend  # wider than the way to closure: the width that fits
    gaps = np.linspace(-1e-4, 3e-4, 8001)
    h = coefficient(heat, gaps)
    outside = (gaps <= low) | (gaps >= high)
    np.testing.assert_allclose(h[outside], coefficient(sharp, gaps)[outside], rtol=1e-10)
    inside = (gaps > low + 1e-7) & (gaps < high - 1e-7)
    assert (np.abs(h - coefficient(sharp, gaps))[inside] > 1e-9).all()
    bends = [np.abs(np.diff(np.diff(coefficient(x, gaps)) / np.diff(gaps))).max()
             for x in (sharp, heat)]  # fmt: skip
    assert bends[1] < 0.1 * bends[0]


def test_rounded_law_leaves_closure_flat_under_pressure():
    """Both sides of closure have slope zero: the law has a continuous slope through it."""
    heat = {**SERIES, "pressure": PRESSURE, "transition": "10 um"}
    knee = SMALLEST_RELATIVE_PRESSURE * 1.2e9
    small = (coefficient(heat, 0.0, 1e-4 * knee) - 800) / (coefficient(heat, 0.0, knee) - 800)
    assert abs(small[0]) < 1e-6  # a straight line would give 1e-4
    step = 1e-4 * knee
    sides = [(coefficient(heat, 0.0, knee + s) - coefficient(heat, 0.0, knee)) / s
             for s in (-step, step)]  # fmt: skip
    assert sides[0] == pytest.approx(sides[1], rel=1e-3)
    sharp = {**SERIES, "pressure": PRESSURE}
    above = np.geomspace(knee, 1e9, 20)
    np.testing.assert_allclose(coefficient(heat, 0.0, above), coefficient(sharp, 0.0, above))


@pytest.mark.parametrize("exponent", [0.5, 0.95])
def test_the_slope_over_pressure_is_bounded(exponent):
    heat = InterfaceHeat.read({**LIMITED, "pressure": {**PRESSURE, "exponent": exponent}})
    power = conduction_law(heat).pressure.power
    knee = SMALLEST_RELATIVE_PRESSURE * 1.2e9
    p = np.geomspace(1e-12, 1e9, 500)
    steepest = power(np.array([knee])) / knee
    assert (np.diff(power(p)) / np.diff(p) <= steepest * (1 + 1e-9)).all()
    np.testing.assert_allclose(power(np.array([knee, 2 * knee])), [1e-6**exponent, 2e-6**exponent])


def test_penetration_counts_as_closed_and_tension_as_no_pressure():
    heat = {**LIMITED, "pressure": PRESSURE}
    np.testing.assert_array_equal(coefficient(heat, -1e-6, -1e6), coefficient(heat, 0.0, 0.0))


@pytest.mark.parametrize("key, other", [("resistance", 2e-5), ("hardness", 2e9), ("exponent", 0.8)])
def test_every_number_of_the_pressure_law_acts(key, other):
    changed = {**LIMITED, "pressure": {**PRESSURE, key: other}}
    before = coefficient({**LIMITED, "pressure": PRESSURE}, 0.0, 1e8)
    assert abs(coefficient(changed, 0.0, 1e8) - before) > 1.0


DIFFERENTIATED: list[dict[str, Any]] = [
    {"law": "constant", "closed": FALLING},
    {"law": "constant", "closed": {**FALLING, "of": "primary"}},
    {"law": "limited", "closed": {**FALLING, "of": "mean"}, "gas_conductivity": GAS},
    {"law": "limited", "closed": FALLING, "gas_conductivity": GAS, "transition": "60 um"},
    {"law": "limited", "closed": FALLING, "gas_conductivity": GAS, "transition": "1 mm"},
    {"law": "series", "closed": FALLING, "gas_conductivity": GAS, "transition": "60 um"},
    {**ROUGH, "gas_conductivity": GAS, "pressure": {"hardness": 1e9}},
    {"law": "solid-fraction", "closed": FALLING, "open": {**FALLING, "of": "mean"}},
]


@pytest.mark.parametrize("heat", DIFFERENTIATED)
def test_derivatives_over_temperatures_and_solid_fraction(heat):
    gaps = np.array([0.0, 10e-6, 45e-6, 80e-6, 300e-6])
    state = {"gap": gaps, "pressure": np.where(gaps > 0, 0.0, 3e6)}
    at = {"secondary": 470.0, "primary": 140.0, "solid": 0.4}
    found = conductance(heat, **state, **at).coefficient.slopes
    names = {SECONDARY: "secondary", PRIMARY: "primary", SOLID: "solid"}
    assert np.abs(found).max() > 0.0
    for number, name in names.items():
        step = 1e-4 * (at[name] if name != "solid" else 1.0)
        ends = [coefficient(heat, **state, **{**at, name: at[name] + s}) for s in (-step, step)]
        np.testing.assert_allclose(
            found[number], (ends[1] - ends[0]) / (2 * step), rtol=1e-5, atol=1e-6
        )
