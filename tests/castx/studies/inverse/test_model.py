"""A measured case as a model: its runs, and starts that are refused."""

import pytest

from castx.errors import CaseError, ConvergenceError
from castx.studies.inverse.model import MeasuredCase
from castx.studies.runs.executor import Ended
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
    text = "the start of all unknowns is not converged: too fast; give another start"
    with pytest.raises(CaseError, match=text):
        model.refuse_bad_start()


@pytest.mark.parametrize(
    ("ended", "text"),
    [
        (Ended(2, "refused: probe 'near +9' is outside", 1, 1), "three depth_deviations, 0.9 mm"),
        (Ended(2, "refused: no such surface", 1, 1), "no such surface; correct the case"),
        (Ended(130, "the time limit of 1 s", 1, 1), "raise time_limit, or time of slurm, and"),
        (Ended(1, "MemoryError", 1, 1), "MemoryError; see what it lacked"),
    ],
)
def test_a_start_that_cannot_run_has_its_own_cure(tmp_path, ended, text):
    class Ending:
        def ended(self, tasks):
            yield 0, ended

    model = MeasuredCase.of(*opened(tmp_path, depth=True, executor=Ending()))
    with pytest.raises(CaseError, match=text):
        model.refuse_bad_start()


@pytest.mark.parametrize(
    ("unknown", "text"),
    [
        ({"of": "interfaces.0.heat.close", "start": 900}, r'\[identify\] h: .*mean "closed"'),
        ({"of": "interfaces.7.heat.closed", "start": 900}, r"\[identify\] h: .*has no '7'"),
        ({"of": "materials.di.density", "start": 900}, r'no \[materials.di\]; .*mean "die"'),
        ({"of": "vary.draws", "start": 900}, r"\[vary\] is a study; a number of the case"),
        ({"start": "2 mm"}, r"\[identify\] h: .*closed = \"2.0 mm\": 'mm' is not a unit"),
    ],
)
def test_what_the_case_does_not_take_is_refused_before_a_run(tmp_path, unknown, text):
    runner, study = opened(tmp_path, unknown=unknown)
    with pytest.raises(CaseError, match=text):
        MeasuredCase.of(runner, study)
    assert runner.made == 0


def test_an_unknown_without_influence_is_refused(tmp_path):
    other = {"of": "materials.die.conductivity", "name": "k"}
    model = MeasuredCase.of(*opened(tmp_path, others=[other]))
    with pytest.raises(CaseError, match="k has no influence on any sample: leave it out"):
        model.refuse_bad_start()
    known = MeasuredCase.of(*opened(tmp_path, others=[{**other, "deviation": 0.1}]))
    known.refuse_bad_start()
    assert known.runner.made == 0  # all three runs are those of before
