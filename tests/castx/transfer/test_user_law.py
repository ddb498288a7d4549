"""Laws as Python functions: checked when made, and the same answers as the laws of a case."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.process.simulation import Simulation
from castx.transfer.conductance import PRIMARY, SECONDARY, Faces
from castx.transfer.pair_state import PairState
from castx.transfer.user_law import UserLaw
from tests.coupled_cases import cylinder, merged


def limited(gap, pressure, hot, cold, time):
    """Return min(2300, k/g) with a gas that conducts better when hot, and h(p)."""
    k = 0.02 + 2e-5 * (hot + cold)
    return 1.0 / np.maximum(1 / 2300.0, gap / k) + 1e-6 * pressure


def slopes(gap, pressure, hot, cold, time):
    k = 0.02 + 2e-5 * (hot + cold)
    through = np.where(gap > k / 2300.0, 2e-5 / np.maximum(gap, 1e-9), 0.0)
    return through, through


@pytest.mark.serial
@pytest.mark.parametrize("given", [slopes, None])
def test_derivatives_given_or_differenced(given):
    law = UserLaw(limited, given)
    gap = np.array([0.0, 5e-6, 1e-4])
    faces = Faces.at_temperatures(np.full(3, 500.0), np.full(3, 100.0), 0.0, 0.0)
    found = law(PairState.of(gap, np.zeros(3)), faces)
    assert found.coefficient.value == pytest.approx(limited(gap, 0.0, 500.0, 100.0, 0.0))
    expected = slopes(gap, 0.0, 500.0, 100.0, 0.0)
    for number, slope in zip((SECONDARY, PRIMARY), expected, strict=True):
        assert found.coefficient.slopes[number] == pytest.approx(slope, rel=1e-6, abs=1e-6)
    assert found.contact == pytest.approx([1.0, 0.0, 0.0])


def wrong(gap, pressure, hot, cold, time):
    return slopes(gap, pressure, hot, cold, time)[0], np.zeros(len(gap))


@pytest.mark.serial
@pytest.mark.parametrize(
    "coefficient, given, text",
    [
        (limited, wrong, "slope over the primary temperature is 0 W/m²/K², but the law changes by"),
        (lambda g, p, hot, cold, t: np.where(g > 0, 100.0, 900.0), None, "law jumps at closure"),
        (lambda g, p, hot, cold, t: 1e3 - hot, None, "finite and not negative; the law gives -"),
        (lambda g, p, hot, cold, t: 100.0 / (g - g), None, "must be finite"),
        (lambda g, p, hot, cold, t: 5.0, None, r"one number for each pair: \(200,\), not \(\)"),
    ],
)
def test_refused(coefficient, given, text):
    with pytest.raises(CaseError, match=text), np.errstate(divide="ignore", invalid="ignore"):
        UserLaw(coefficient, given)


@pytest.mark.serial
def test_a_law_may_jump_at_closure_by_less_than_a_millionth():
    def jumping(share):
        return lambda g, p, hot, cold, t: np.where(g > 0, 1.0 - share, 1.0) * 900.0

    UserLaw(jumping(3e-7))
    with pytest.raises(CaseError, match="jumps at closure"):
        UserLaw(jumping(3e-6))


@pytest.mark.serial
def test_one_bad_sample_is_enough():
    def once(g, p, hot, cold, t):
        return np.where(hot == hot.max(), -1.0, 900.0)

    with pytest.raises(CaseError, match="finite and not negative"):
        UserLaw(once)


@pytest.mark.serial
@pytest.mark.parametrize("argument, limit", [(0, 2e-3), (1, 2e8), (2, 1600.0), (3, 1600.0)])
def test_a_law_is_tried_up_to_the_largest_values_that_castings_have(argument, limit):
    """Gap, pressure and both temperatures: it may be wrong beyond, and not just below."""

    def wrong_beyond(value):
        return lambda *given: np.where(given[argument] > value, -1.0, 900.0)

    UserLaw(wrong_beyond(1.01 * limit))
    with pytest.raises(CaseError, match="finite and not negative"):
        UserLaw(wrong_beyond(0.9 * limit))


def heats(comm, data, laws=None) -> list[float]:
    run = Simulation.from_case(read_case(data, Path("case.toml")), comm, laws)
    return [state.totals["casting/mould.heat"] for state in run]


def test_a_driver_replaces_the_law_of_an_interface(comm):
    """The law of a case as a function gives the heat that the case gives; another does not."""
    steps = {"time": {"end": 4.0, "fixed_step": 2.0}}
    gas = {"over": "temperature", "table": [[0, 0.02], [2000, 0.1]]}
    data = cylinder(steps)
    data["interfaces"][0]["heat"] |= {
        "gas_conductivity": gas, "pressure": {"resistance": 1.0, "hardness": 1e6, "exponent": 1.0},
        "radiation": {"emissivities": [0.4, 0.8]},
    }  # fmt: skip
    own = heats(comm, data)
    assert heats(comm, data, {"casting/mould": UserLaw(limited)}) == pytest.approx(own, rel=1e-6)
    other = merged(data, {})
    other["interfaces"][0]["heat"]["radiation"]["emissivities"] = [0.1, 0.1]
    assert heats(comm, other, {"casting/mould": UserLaw(limited)})[-1] < own[-1] * (1 - 1e-4)
    with pytest.raises(CaseError, match="a law for the interface 'mould'"):
        heats(comm, data, {"mould": UserLaw(limited)})


@pytest.mark.serial
@pytest.mark.parametrize(
    ("later", "text"),
    [(-5.0, "the law gives -5 W/m²/K at gap 0 m"), (np.nan, "must be finite")],
)
def test_a_law_that_turns_wrong_during_a_run_is_refused(later, text):
    def law(gap, pressure, hot, cold, time):
        return np.full(len(gap), 900.0 if time < 3.0 else later)

    made, faces = UserLaw(law), (np.full(2, 500.0), np.full(2, 100.0))
    pairs = PairState.of(np.zeros(2), np.zeros(2))
    assert made(pairs, Faces.at_temperatures(*faces, 0.0, 0.0)).coefficient.value[0] == 900.0
    with pytest.raises(CaseError, match=text):
        made(pairs, Faces.at_temperatures(*faces, 3.5, 0.0))


@pytest.mark.serial
@pytest.mark.parametrize(("jump", "refused"), [(3e-7, False), (3e-6, True)])
def test_a_jump_at_closure_counts_from_a_millionth_on(jump, refused):
    def law(gap, pressure, hot, cold, time):
        return np.where(gap > 0.0, 900.0 * (1.0 - jump), 900.0)

    if refused:
        with pytest.raises(CaseError, match="law jumps at closure"):
            UserLaw(law)
    else:
        UserLaw(law)
