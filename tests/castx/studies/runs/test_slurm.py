"""Jobs of Slurm, here without it: settings, results, lost jobs, none that is left behind."""

from __future__ import annotations

import time

import pytest

from castx.errors import CaseError
from castx.studies.asked.slurm import SlurmJobs
from castx.studies.runs import slurm
from castx.studies.runs.executor import Ended, Task
from castx.studies.runs.slurm import LOST, SlurmArrays

pytestmark = pytest.mark.serial


@pytest.fixture
def given(monkeypatch):
    """Let processes of this machine stand for the jobs of a cluster; its settings."""
    submitit = pytest.importorskip("submitit")
    found = {}

    class Jobs(submitit.LocalExecutor):
        def update_parameters(self, **settings):
            found.update(settings)
            super().update_parameters(timeout_min=1)

    monkeypatch.setattr(submitit, "SlurmExecutor", Jobs)
    monkeypatch.setattr(slurm, "PATIENCE", 0.05)
    return found


def tasks(folder, *options):
    return [Task(("info", *one), folder / f"log{k}") for k, one in enumerate(options)]


def test_jobs_bring_what_the_runs_have_said(given, tmp_path):
    asked = SlurmJobs.read({"partition": "main", "account": "melt", "time": "90 s"})
    executor = SlurmArrays(asked, tmp_path / "jobs", at_once=3, memory=2.5e9)
    found = dict(executor.ended(tasks(tmp_path, (), ("--no-such-option",))))
    assert found[0].code == 0 and found[0].processor_seconds > 0.1
    assert found[1].code == 2 and "no-such-option" in found[1].said
    wanted = {"partition": "main", "account": "melt", "qos": None, "time": 2, "mem": "2500MB",
              "array_parallelism": 3, "cpus_per_task": 1}  # fmt: skip
    assert {key: given[key] for key in wanted} == wanted


def test_a_job_without_a_result_is_lost(given, tmp_path, monkeypatch):
    monkeypatch.setattr(slurm, "run_here", fails)
    ((_, ended),) = SlurmArrays(SlurmJobs(), tmp_path / "jobs").ended(tasks(tmp_path, ()))
    assert ended.code == LOST and ended.said.startswith("job ")
    assert "no castx on this node" in ended.said


def fails(task):
    raise OSError("no castx on this node")


def test_no_job_is_left_behind(given, tmp_path, monkeypatch):
    monkeypatch.setattr(slurm, "run_here", short_or_long)
    asked = tasks(tmp_path, ("short",), ("long",))
    going = SlurmArrays(SlurmJobs(), tmp_path / "jobs").ended(asked)
    assert next(going) == (0, Ended(0, "", 0.0, 0.0))
    going.close()
    for _ in range(200):
        if (tmp_path / "log1").read_text() == "stopped":
            return
        time.sleep(0.05)
    pytest.fail("the job goes on")


def short_or_long(task):
    if "long" in task.arguments:
        task.log.write_text("began")
        try:
            time.sleep(60)
        finally:
            task.log.write_text("stopped")
    while not (task.log.parent / "log1").exists():
        time.sleep(0.01)
    return Ended(0, "", 0.0, 0.0)


def test_what_is_missing_is_said(tmp_path, monkeypatch):
    executor = SlurmArrays(SlurmJobs(), tmp_path / "jobs")
    monkeypatch.setattr(slurm, "find_spec", lambda name: None)
    with pytest.raises(CaseError, match="needs the package submitit: pip install submitit"):
        next(executor.ended(tasks(tmp_path, ())))
    monkeypatch.undo()
    pytest.importorskip("submitit")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(CaseError, match="start the study on a machine of the cluster"):
        next(executor.ended(tasks(tmp_path, ())))
