"""A measured case as a model: its runs, and starts that are refused."""

import pytest

from castx.errors import CaseError, ConvergenceError
from castx.studies.inverse.model import MeasuredCase
from tests.castx.cooled_mould import TIME, temperature
from tests.castx.studies.inverse.measured_case import opened

pytestmark = pytest.mark.serial


def test_samples_are_those_of_the_formula_and_depth_costs_no_run(tmp_path):
    runner, study = opened(tmp_path, depth=True)
    model = MeasuredCase.of(runner, study)
    assert model.names() == ["h", "depth of near"]
    found = model({"h": 1000.0, "depth of near": 1e-4})
    exact = temperature(1000.0 + 0.0 * TIME, 2.1e-3)
    assert found == pytest.approx(exact[: len(found)], abs=0.02)
    model({"h": 1000.0, "depth of near": -2e-4})
    assert runner.made == 1


def test_failed_and_refused_runs_are_refused_steps(tmp_path):
    model = MeasuredCase.of(*opened(tmp_path))
    with pytest.raises(ConvergenceError, match="not converged: too fast"):
        model({"h": 2e5})
    with pytest.raises(ConvergenceError, match=r"refused: .*closed"):
        model({"h": -1.0})


def test_a_start_that_fails_is_refused(tmp_path):
    model = MeasuredCase.of(*opened(tmp_path, unknown={"start": 2e5}))
    with pytest.raises(CaseError, match="the start of all unknowns is not converged: too fast"):
        model.refuse_bad_start()


def test_an_unknown_without_influence_is_refused(tmp_path):
    other = {"of": "materials.die.conductivity", "name": "k"}
    model = MeasuredCase.of(*opened(tmp_path, others=[other]))
    with pytest.raises(CaseError, match="k has no influence on any sample: leave it out"):
        model.refuse_bad_start()
    known = MeasuredCase.of(*opened(tmp_path, others=[{**other, "deviation": 0.1}]))
    known.refuse_bad_start()
    assert known.runner.made == 0  # all three runs are those of before
