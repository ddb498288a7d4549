"""The registered laws: found by themselves, continuous at closure, with true derivatives."""

from __future__ import annotations

import random
from dataclasses import replace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import pytest

import castx.transfer.laws
from castx.case.heat_transfer import InterfaceHeat
from castx.errors import CaseError
from castx.input.entries import Description, Quantity
from castx.input.units import HEAT_TRANSFER, LENGTH
from castx.transfer import keys
from castx.transfer.conductance import PRIMARY, SECONDARY, SOLID, ConstantConductance
from castx.transfer.declaration import GapHeatLaw, HeatKey
from castx.transfer.registry import gap_heat_laws, law_keys, law_table, with_keys_of_laws
from tests.castx.transfer.law_samples import (
    BY_GAP,
    BY_PRESSURE,
    CONDUCTING,
    FALLING,
    GAS,
    LIMITED,
    PRESSURE,
    ROUGH,
    SERIES,
    coefficient,
    conductance,
    varying,
)

pytestmark = pytest.mark.serial

LAWS = [gap_heat_laws()[name] for name in CONDUCTING]


def test_every_file_of_the_room_is_a_law():
    folder = Path(castx.transfer.laws.__path__[0])
    files = {path.stem.replace("_", "-") for path in folder.glob("*.py")} - {"--init--"}
    assert set(gap_heat_laws()) == files


def test_castings_drawn_at_random_have_every_law():
    path = Path(__file__).parents[3] / "bench/robustness.py"
    spec = spec_from_file_location("robustness", path)
    assert spec is not None and spec.loader is not None
    robustness = module_from_spec(spec)
    spec.loader.exec_module(robustness)
    drawn = [robustness.heat_law(random.Random(seed)) for seed in range(300)]
    missing = set(gap_heat_laws()) - {InterfaceHeat.read(heat).law for heat in drawn}
    assert not missing, f"bench/robustness.py never draws the laws {sorted(missing)}"


def test_two_laws_cannot_read_one_key_in_two_ways():
    other = replace(keys.CLOSED, entry=Quantity(LENGTH))
    laws = {"a": declared(needed=(keys.CLOSED,)), "b": declared(name="b", needed=(other,))}
    with pytest.raises(TypeError, match="law 'b' declares the key 'closed' otherwise"):
        law_keys(laws)


def declared(**changes):
    texts = {"name": "a", "summary": "a", "formula": "a", "source": "a"}
    return GapHeatLaw(build=lambda given: ConstantConductance(), **(texts | changes))


def test_keys_of_a_law_become_fields_of_the_case(monkeypatch):
    """A law with a key of its own: read with its unit and bounds, refused in other laws."""
    entry = Quantity(LENGTH, above=0.0)
    own = HeatKey("decay", "gap over which h falls", entry, usual=(1e-5, 1e-3))
    law = declared(needed=(keys.CLOSED, own))
    monkeypatch.setattr("castx.transfer.registry.gap_heat_laws", lambda: {"a": law})

    @with_keys_of_laws
    class Heat(Description):
        closed: Annotated[float | None, Quantity(HEAT_TRANSFER)] = None

    assert list(Heat.model_fields) == ["closed", "decay"]
    assert Heat.read({"closed": 5, "decay": "2 mm"}).decay == pytest.approx(2e-3)
    assert Heat.read({}).decay is None
    with pytest.raises(CaseError, match=r"decay: must be positive \(in m\)"):
        Heat.read({"decay": 0})
    with pytest.raises(CaseError, match="unknown key; known keys: closed, decay"):
        Heat.read({"lenght": 0})


def test_the_table_of_laws_has_keys_with_units():
    rows = {row.name: row for row in law_table()}
    assert list(rows) == list(gap_heat_laws())
    assert rows["series"].needed == "closed [W/m²/K], gas_conductivity [W/m/K]"
    assert rows["series"].useful.startswith("pressure, transition [m], roughness")
    assert rows["perfect"].needed == ""


@pytest.mark.parametrize("law", gap_heat_laws().values(), ids=lambda law: law.name)
def test_radiation_passes_beside_every_law_but_perfect_contact(law):
    takes = keys.RADIATION in law.keys
    assert takes == (law.exchange != "perfect"), "RADIATION belongs to the keys of use"


@pytest.mark.parametrize(
    "name, key",
    [(law.name, key) for law in LAWS for key in law.keys if key.is_number],
    ids=lambda value: getattr(value, "name", value),
)
def test_no_number_of_a_law_may_be_negative(name, key):
    heat = gap_heat_laws()[name].example() | {key.name: -key.usual[0]}
    with pytest.raises(CaseError, match=f"{key.name}.*: must be (positive|at least 0)"):
        InterfaceHeat.read(heat)


@pytest.mark.parametrize("name, key", [(law.name, key) for law in LAWS for key in law.needed],
                         ids=lambda value: getattr(value, "name", value))  # fmt: skip
def test_every_needed_key_acts(name, key):
    """Without it the law is refused; at both ends of its usual range the coefficients differ."""
    law = gap_heat_laws()[name]
    heat = law.example()
    with pytest.raises(CaseError, match=f"{key.name}: missing; the law '{name}' needs it"):
        coefficient({other: value for other, value in heat.items() if other != key.name})
    gaps, pressures = np.array([0.0, 0.0, 1e-5, 1e-4, 1e-3]), np.array([0.0, 1e7, 0.0, 0.0, 0.0])
    low, high = (coefficient({**heat, key.name: value}, gaps, pressures) for value in key.usual)
    assert np.abs(high - low).max() > 0.01 * low.min()


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_coefficients_are_finite_numbers_and_the_contact_has_a_share(law):
    rng = np.random.default_rng(1)
    gap = np.where(rng.random(500) < 0.5, 0.0, 10.0 ** rng.uniform(-9, -1, 500))
    pressure = np.where(gap == 0.0, 10.0 ** rng.uniform(-3, 10, 500), 0.0)
    hot, cold = rng.uniform(-50.0, 2000.0, (2, 500))
    for heat in (law.example(), varying(law)):
        found = conductance(heat, gap, pressure, hot, cold, time=1e4, solid=rng.random())
        assert np.isfinite(found.coefficient.value).all()
        assert np.isfinite(found.coefficient.slopes).all()
        assert (found.coefficient.value >= 0.0).all()
        assert ((found.contact >= 0.0) & (found.contact <= 1.0)).all()


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_a_law_says_whether_it_needs_the_solid_fraction(law):
    built = InterfaceHeat.read(law.example()).conduction_law()
    assert built.needs_solid_fraction == law.needs_solid_fraction
    values = [coefficient(law.example(), [0.0, 1e-4], solid=solid) for solid in (0.1, 0.8)]
    assert (np.abs(values[1] - values[0]) > 0.0).any() == law.needs_solid_fraction


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_a_law_says_whether_it_follows_the_gap(law):
    values = coefficient(law.example(), [0.0, 1e-3], solid=0.5)
    assert (values[1] < values[0]) == law.follows_gap


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


def law_of(heat: object) -> str | None:
    """Return the name of the law of a case, for the name of a test."""
    return heat.get("law") if isinstance(heat, dict) else None


CONTINUOUS: list[dict[str, Any]] = [
    *(law.example() for law in LAWS),
    *(varying(law) for law in LAWS),
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


@pytest.mark.parametrize("heat", CONTINUOUS, ids=law_of)
@pytest.mark.parametrize("pressure", [None, {**PRESSURE, "exponent": 0.6}])
def test_every_law_is_continuous_at_closure(heat, pressure):
    if pressure is not None and keys.PRESSURE in gap_heat_laws()[heat["law"]].useful:
        heat = {**heat, "pressure": pressure}
    touching = coefficient(heat)
    assert coefficient(heat, 1e-13) == pytest.approx(touching, rel=1e-5)
    assert coefficient(heat, 0.0, 1e-3) == pytest.approx(touching, rel=1e-5)


DIFFERENTIATED: list[dict[str, Any]] = [
    *(varying(law) for law in LAWS),
    {"law": "constant", "closed": FALLING},
    {"law": "constant", "closed": {**FALLING, "of": "primary"}},
    {"law": "limited", "closed": {**FALLING, "of": "mean"}, "gas_conductivity": GAS},
    {"law": "limited", "closed": FALLING, "gas_conductivity": GAS, "transition": "60 um"},
    {"law": "limited", "closed": FALLING, "gas_conductivity": GAS, "transition": "1 mm"},
    {"law": "series", "closed": FALLING, "gas_conductivity": GAS, "transition": "60 um"},
    {**ROUGH, "gas_conductivity": GAS, "pressure": {"hardness": 1e9}},
    {"law": "solid-fraction", "closed": FALLING, "open": {**FALLING, "of": "mean"}},
]


@pytest.mark.parametrize("heat", DIFFERENTIATED, ids=law_of)
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
