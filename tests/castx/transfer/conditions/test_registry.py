"""The registered heat conditions: found by themselves, in the case, with true derivatives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import castx.transfer.conditions
from castx.case.boundaries import HeatCondition
from castx.errors import CaseError
from castx.input.entries import Tabulated
from castx.input.placed import PlacedOverTime
from castx.input.variation import Varying
from castx.tables import Table
from castx.transfer.conditions.keys import AMBIENT
from castx.transfer.conditions.registry import OTHERS, heat_conditions, key_names
from tests.heat_conditions import flux_law

pytestmark = pytest.mark.serial

CONDITIONS = list(heat_conditions().values())
FLUXES = [kind for kind in CONDITIONS if kind.flux is not None]
KEYS = [(kind, key) for kind in CONDITIONS for key in kind.keys]
TEMPERATURES = np.array([-40.0, 80.0, 300.0, 650.0, 1300.0])


def named(value):
    return value.name




def test_every_file_of_the_room_is_a_condition():
    folder = Path(castx.transfer.conditions.__path__[0])
    files = {path.stem.replace("_", "-") for path in folder.glob("[!_]*.py")} - set(OTHERS)
    assert set(heat_conditions()) == files
    assert {"insulated", "temperature", "flux", "convection", "radiation"} <= files


def test_keys_of_conditions_are_fields_of_the_case():
    assert set(HeatCondition.model_fields) == {"type", *key_names()}
    assert len(set(key_names())) == len(key_names())


@pytest.mark.parametrize("kind", CONDITIONS, ids=named)
def test_a_case_takes_every_condition_with_usual_numbers(kind):
    for choose in (min, max):
        condition = HeatCondition.read(kind.example(choose))
        assert condition.declared is kind
        assert set(condition.given.values) == {key.name for key in kind.keys}


@pytest.mark.parametrize("kind, key", KEYS, ids=named)
def test_every_key_acts(kind, key):
    """Without it the condition is refused; at both ends of its usual range heat differs."""
    case = kind.example()
    if key.default is None:
        text = f"{key.name}: missing; heat of type '{kind.name}' needs it"
        with pytest.raises(CaseError, match=text):
            HeatCondition.read({name: v for name, v in case.items() if name != key.name})
    ends = [HeatCondition.read({**case, key.name: value}).given for value in key.usual]
    if kind.temperature is not None:
        low, high = (kind.temperature(given)(0.0) for given in ends)
    else:
        low, high = (kind.flux(given)(0.0, 1.0, TEMPERATURES)[0] for given in ends)
    assert (np.abs(high - low) > 0.01 * np.abs(low)).any()


@pytest.mark.parametrize("kind, key", KEYS, ids=named)
def test_a_number_has_a_unit_and_refuses_others(kind, key):
    with pytest.raises(CaseError, match=f"{key.name}: 'mol' is not a unit of"):
        HeatCondition.read({**kind.example(), key.name: "3 mol"})


@pytest.mark.parametrize(
    "kind, key", [(kind, key) for kind, key in KEYS if key.unit not in ("degC", "W/m^2")], ids=named
)
def test_only_temperatures_and_fluxes_may_be_negative(kind, key):
    with pytest.raises(CaseError, match=f"{key.name}.*: must be (positive|at least 0)"):
        HeatCondition.read({**kind.example(), key.name: -key.usual[0]})


@pytest.mark.parametrize("kind", CONDITIONS, ids=named)
def test_keys_of_other_conditions_are_refused(kind):
    for other in CONDITIONS:
        for key in other.keys:
            if kind.key(key.name) is None:
                text = f"{key.name}: heat of type '{kind.name}' uses "
                with pytest.raises(CaseError, match=text):
                    HeatCondition.read({**kind.example(), key.name: key.usual[0]})


@pytest.mark.parametrize("kind", FLUXES, ids=named)
def test_slopes_of_fluxes_by_differences(kind):
    law, T, step = flux_law(**kind.example()), TEMPERATURES, 1e-3
    flux, slope = law(2.0, 6.0, T)
    assert flux.shape == slope.shape == T.shape and np.isfinite(flux).all()
    rise = (law(2.0, 6.0, T + step)[0] - law(2.0, 6.0, T - step)[0]) / (2 * step)
    np.testing.assert_allclose(slope, rise, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("kind", [kind for kind in FLUXES if AMBIENT in kind.keys], ids=named)
def test_heat_goes_to_the_colder_side_and_faster_the_colder_it_is(kind):
    case = kind.example() | {AMBIENT.name: 300.0}
    flux, slope = flux_law(**case)(0.0, 1.0, np.array([100.0, 299.0, 300.0, 301.0, 900.0]))
    assert (np.sign(flux) == [1.0, 1.0, 0.0, -1.0, -1.0]).all()
    assert (np.diff(flux) < 0.0).all() and np.isfinite(slope).all() and (slope <= 0.0).all()


def over_time(key) -> bool:
    whole = isinstance(key.entry, Tabulated | PlacedOverTime)
    return whole or (isinstance(key.entry, Varying) and key.entry.rows)


@pytest.mark.parametrize(
    "kind, key", [(kind, key) for kind, key in KEYS if kind.flux and over_time(key)], ids=named
)
def test_what_is_given_over_time_enters_by_its_mean(kind, key):
    """From 2 to 6 s: the mean is the value at 4 s."""
    low, high = key.usual
    case = kind.example()
    found = flux_law(**case | {key.name: [[0.0, low], [10.0, high]]})(2.0, 6.0, TEMPERATURES)
    mean = flux_law(**case | {key.name: low + 0.4 * (high - low)})(2.0, 6.0, TEMPERATURES)
    np.testing.assert_allclose(found, mean, rtol=1e-12)


@pytest.mark.parametrize("kind", CONDITIONS, ids=named)
def test_temperatures_that_a_condition_names_are_those_of_the_case(kind):
    numbers = [key.name for key in kind.keys if key.unit == "degC"]
    given = {name: [[0.0, 15.0], [9.0, 95.0]] for name in numbers}
    found = HeatCondition.read({**kind.example(), **given}).temperatures
    assert [(t.values.min(), t.values.max()) for t in found] == [(15.0, 95.0)] * len(numbers)
    assert all(isinstance(table, Table) for table in found)
