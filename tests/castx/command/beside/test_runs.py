"""Runs beside a run have folders of their own inside its folder."""

import pytest

from castx.case.reading.coarser import with_larger_steps
from castx.case.reading.read import load_case
from castx.command.beside import runs
from castx.command.run import RunSettings, with_output
from castx.errors import ConvergenceError, MeshError
from castx.results.reading import Results

SHORT = ["time.end=0.1"]


def cases(case_file, folder):
    case = with_output(load_case(case_file, SHORT), folder)
    return case, with_output(with_larger_steps(case, 2.0), folder / "beside")


def test_the_other_run_stands_inside(comm, case_file, shared_tmp_path):
    case, other = cases(case_file, shared_tmp_path / "out")
    folder = runs.run_beside(case, [other], RunSettings(comm))
    steps = [Results(f).record["totals"]["steps"] for f in (folder, folder / "beside")]
    assert steps[0] > steps[1] > 0


@pytest.mark.serial
def test_another_run_that_does_not_converge_stops_nothing(
    comm, case_file, tmp_path, monkeypatch, caplog
):
    case, other = cases(case_file, tmp_path / "out")
    error = ConvergenceError("no solution")
    monkeypatch.setattr(runs, "run_case", failing_in("beside", error))
    assert runs.run_beside(case, [other], RunSettings(comm)) == tmp_path / "out"
    monkeypatch.setattr(runs, "run_case", failing_in("beside", MeshError("flat cells")))
    with pytest.raises(MeshError, match="flat cells"):
        runs.run_beside(case, [other], RunSettings(comm))


@pytest.mark.serial
def test_all_runs_share_the_time(comm, case_file, tmp_path, monkeypatch):
    case, other = cases(case_file, tmp_path / "out")
    left = []

    def noted(case, settings):
        left.append(settings.time_limit)
        return case.output.folder

    monkeypatch.setattr(runs, "run_case", noted)
    runs.run_beside(case, [other], RunSettings(comm, time_limit=50.0))
    assert 50.0 >= left[0] > left[1] > 40.0


def failing_in(name, error):
    def run_case(case, settings):
        if case.output.folder.name == name:
            raise error
        return case.output.folder

    return run_case
