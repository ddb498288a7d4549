"""Jobs of Slurm, here without it: settings, results, lost jobs, none that is left behind."""

from __future__ import annotations

import math
import os
import signal
import time

import pytest

from castx.errors import CaseError
from castx.signals import STOPPED
from castx.studies.asked.slurm import SlurmJobs
from castx.studies.runs import slurm
from castx.studies.runs.executor import Ended, Task
from castx.studies.runs.local import LocalProcesses
from castx.studies.runs.slurm import LOST, Absences, SlurmArrays, run_here

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
              "array_parallelism": 3, "cpus_per_task": 1, "signal_delay_s": 30}  # fmt: skip
    assert {key: given[key] for key in wanted} == wanted


def test_a_job_without_a_result_is_lost(given, tmp_path, monkeypatch):
    monkeypatch.setattr(slurm, "run_here", fails)
    ((_, ended),) = SlurmArrays(SlurmJobs(), tmp_path / "jobs").ended(tasks(tmp_path, ()))
    assert ended.code == LOST and ended.said.startswith("job ")
    assert "no castx on this node" in ended.said


def fails(task):
    raise OSError("no castx on this node")


@pytest.fixture
def queue(tmp_path, monkeypatch):
    """Let a program that prints a file stand for `squeue`; the file."""
    programs, file = tmp_path / "bin", tmp_path / "queue"
    programs.mkdir()
    program = programs / "squeue"
    program.write_text(f'#!/bin/sh\necho "$@" >{tmp_path}/asked\ncat {file}\n')
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setattr(slurm, "LOOKS", 0.3)
    return file


def ends_without_a_word(task):
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_job_that_is_gone_is_lost_by_two_looks_at_the_queue(given, queue, tmp_path, monkeypatch):
    """Without accounts of jobs too."""
    monkeypatch.setattr(slurm, "run_here", ends_without_a_word)
    queue.write_text("1_0\n")
    start = time.monotonic()
    ((_, ended),) = SlurmArrays(SlurmJobs(), tmp_path / "jobs").ended(tasks(tmp_path, ()))
    assert time.monotonic() - start > 0.6
    assert ended.code == LOST and "is gone without a result: " in ended.said
    assert (tmp_path / "asked").read_text().split()[-2:] == [f"--user={os.getuid()}", "--format=%i"]


def test_what_the_queue_tells_of_jobs(queue, monkeypatch):
    jobs = {0: "7_0", 1: "7_1", 2: "8"}
    looks = Absences(last=-math.inf)
    monkeypatch.setattr(slurm, "LOOKS", 0.0)

    def lost(text):
        queue.write_text(text)
        return looks.lost(jobs)

    assert lost("7_1\n") == [] and looks.absent == {0, 2}
    assert lost("7_0\n7_1\n") == [2]  # the first one waits again
    assert lost("7_1\n") == [2] and lost("8\n7_1\n") == [0]
    queue.unlink()  # as it fails where Slurm does not answer
    assert looks.lost(jobs) == [] and looks.absent == {0}
    monkeypatch.setattr(slurm, "LOOKS", 60.0)
    assert lost("") == []


def test_jobs_of_a_start_that_was_killed_are_cancelled(given, queue, tmp_path, monkeypatch):
    """Before new ones begin; those of other studies stay."""
    (tmp_path / "jobs").mkdir()
    (tmp_path / "jobs" / "7_submission.sh").touch()
    queue.write_text("7_3\n7_4\n8\n")
    monkeypatch.setattr(slurm, "LOOKS", 60.0)
    program = tmp_path / "bin" / "scancel"
    program.write_text(f'#!/bin/sh\necho "$@" >{tmp_path}/cancelled\nprintf 8 >{queue}\n')
    program.chmod(0o755)
    executor = SlurmArrays(SlurmJobs(), tmp_path / "jobs")
    assert list(executor.ended([])) == [] and not (tmp_path / "cancelled").exists()
    ((_, ended),) = executor.ended(tasks(tmp_path, ()))
    assert ended.code == 0 and (tmp_path / "cancelled").read_text() == "7\n"
    queue.write_text("7_3\n")
    program.write_text("#!/bin/sh\n")
    monkeypatch.setattr(slurm, "ANSWER", 0.3)
    with pytest.raises(CaseError, match="the jobs 7 of an earlier start of this study do not end"):
        next(executor.ended(tasks(tmp_path, ())))


def test_a_run_that_slurm_stops_has_no_result_yet(tmp_path, monkeypatch):
    """Since the job may begin again; one after its own time limit has one."""
    said = f"interrupted: {STOPPED}; go on with --resume"
    ends = iter([said, "interrupted: the time limit of 1 s"])
    monkeypatch.setattr(
        LocalProcesses, "ended", lambda self, asked: iter([(0, Ended(130, next(ends), 1.0, 1.0))])
    )
    (task,) = tasks(tmp_path, ())
    with pytest.raises(SystemExit, match=STOPPED):
        run_here(task)
    assert run_here(task).code == 130


def test_the_end_of_the_time_of_a_job(given, tmp_path, monkeypatch):
    monkeypatch.setattr(slurm, "run_here", is_out_of_time)
    ((_, ended),) = SlurmArrays(SlurmJobs(), tmp_path / "jobs").ended(tasks(tmp_path, ()))
    assert ended.code == 130 and ended.said.endswith("the time of the job was over")


def is_out_of_time(task):
    from submitit.core.utils import UncompletedJobError

    raise UncompletedJobError("Job not requeued because: timed-out and not checkpointable.")


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
    monkeypatch.delenv("CASTX_ROOT", raising=False)
    with pytest.raises(CaseError, match="start the study on a machine of the cluster"):
        next(executor.ended(tasks(tmp_path, ())))
    monkeypatch.setenv("CASTX_ROOT", "/cache/debian-13")
    with pytest.raises(CaseError, match="Debian 13 of bin/with-fenicsx: set CASTX_FENICSX=pip"):
        next(executor.ended(tasks(tmp_path, ())))
