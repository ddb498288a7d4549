"""Designs against their formulas: the information of each place, and who comes first."""

import json

import numpy as np
import pytest

from castx.errors import CaseError, ConvergenceError
from castx.studies.inverse.design import RESULT, design
from tests.castx.cooled_mould import TIME, temperature
from tests.castx.studies.inverse.measured_case import opened

pytestmark = pytest.mark.serial


def place(name, depth, **keys):
    return {
        "name": name, "body": "mould", "below": "casting/mould", "depth": depth,
        "at": ["30 mm", "0.5 mm"], **keys,
    }  # fmt: skip


def information(depth, deviation, noise=1.0):
    """Of ln h = ln 2000 with the depth fitted, from differences of the formula."""
    time = np.arange(1.0, 40.0)

    def at(h, place):
        return np.interp(time, TIME, temperature(np.full(len(TIME), h), place))

    slope = (at(2000.0 * np.exp(0.01), depth) - at(2000.0, depth)) / 0.01 / noise
    deeper = (at(2000.0, depth + 1e-4) - at(2000.0, depth)) / 1e-4 / noise
    return slope @ slope - (slope @ deeper) ** 2 / (deeper @ deeper + 1.0 / deviation**2)


def test_deviations_are_those_of_the_formula(tmp_path):
    candidates = [place("far", "8 mm"), place("near", "1 mm"), place("poor", "1 mm", noise=9)]
    runner, study = opened(tmp_path, depth=True, candidates=candidates, sensors=2)
    found = design(runner, study)
    there = information(2e-3, 3e-4) + 1.0 / 9.0
    assert found.numbers == ["h"] and found.before[0] == pytest.approx(there**-0.5, rel=1e-6)
    told = there + np.cumsum([information(1e-3, 3e-4), information(8e-3, 3e-4)])
    for order in (found.d_order, found.a_order):
        assert [one.name for one in order] == ["near", "far"]
        assert [one.deviations[0] for one in order] == pytest.approx(list(told**-0.5), rel=1e-6)
    assert runner.made == found.runs == 2
    record = json.loads((tmp_path / "study" / RESULT).read_text())
    assert record["d_optimal"][0]["name"] == "near"


def test_without_curves(tmp_path):
    runner, study = opened(tmp_path, candidates=[place("a", "1 mm", depth_deviation=0)], curves=[])
    found = design(runner, study)
    assert found.before[0] == pytest.approx(3.0)
    alone = (information(1e-3, 1e-12) + 1.0 / 9.0) ** -0.5
    assert found.d_order[0].deviations[0] == pytest.approx(alone, rel=1e-6)


def test_what_cannot_be_designed_is_refused(tmp_path):
    with pytest.raises(CaseError, match=r"needs \[\[identify.candidates\]\]"):
        design(*opened(tmp_path))
    one = [place("a", "1 mm")]
    with pytest.raises(CaseError, match=r'\[identify\] h: .*did you mean "closed"'):
        design(
            *opened(
                tmp_path,
                candidates=one,
                unknown={"of": "interfaces.0.heat.close", "start": 900},
            )
        )
    with pytest.raises(ConvergenceError, match="too fast"):
        design(*opened(tmp_path, candidates=one, unknown={"start": 2e5}))
