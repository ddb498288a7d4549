"""Processes of this machine: how many at once, limited memory, none left behind."""

import os
import subprocess
import sys
import time

import pytest

from castx.studies.runs import local
from castx.studies.runs.executor import Task
from castx.studies.runs.local import LocalProcesses, last_words

pytestmark = pytest.mark.serial


@pytest.fixture
def scripts(monkeypatch):
    """Let tasks run a line of Python in place of castx."""
    real = subprocess.Popen

    def popen(command, **options):
        return real([sys.executable, "-c", command[3]], **options)

    monkeypatch.setattr(local.subprocess, "Popen", popen)


def tasks(tmp_path, *lines):
    return [Task((line,), tmp_path / f"log{k}") for k, line in enumerate(lines)]


def test_they_run_at_once_but_no_more_than_allowed(scripts, tmp_path):
    """Each marks its life in a folder and counts the others there."""
    line = (
        f"import os, time; f = {str(tmp_path)!r}; open(f + '/on%d' % os.getpid(), 'w'); "
        "time.sleep(0.15); print(sum(n.startswith('on') for n in os.listdir(f))); "
        "time.sleep(0.15); os.remove(f + '/on%d' % os.getpid())"
    )
    found = dict(LocalProcesses(processes=2).ended(tasks(tmp_path, *[line] * 4)))
    assert [found[k].code for k in range(4)] == [0] * 4
    counts = [int(found[k].said) for k in range(4)]
    assert max(counts) == 2


def test_memory_is_limited(scripts, tmp_path):
    line = "bytearray(100_000_000); print('taken')"
    (free,) = dict(LocalProcesses().ended(tasks(tmp_path, line))).values()
    (bound,) = dict(
        LocalProcesses(memory=8e7).ended(tasks(tmp_path, f"import time; time.sleep(0.2); {line}"))
    ).values()
    assert (free.code, free.said) == (0, "taken")
    assert bound.code == 1 and "MemoryError" in bound.said


def test_variables_of_mpi_and_threads(scripts, tmp_path, monkeypatch):
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "3")
    line = "import os; print(os.environ.get('OMPI_COMM_WORLD_RANK'), os.environ['OMP_NUM_THREADS'])"
    (ended,) = dict(LocalProcesses().ended(tasks(tmp_path, line))).values()
    assert ended.said == "None 1"


def test_time_of_processors_is_that_of_each_run(scripts, tmp_path):
    """One works for as long as it says itself, the other one sleeps beside it."""
    lines = [
        "import time\nwhile time.process_time() < 0.3: pass\nprint(time.process_time())",
        "import time; time.sleep(0.4); print(time.process_time())",
    ]
    found = dict(LocalProcesses(processes=2).ended(tasks(tmp_path, *lines)))
    for ended in found.values():
        assert ended.processor_seconds == pytest.approx(float(ended.said), abs=0.05)
    assert found[1].seconds > 0.4 and found[0].processor_seconds > 0.3


def test_none_is_left_behind(scripts, tmp_path):
    lines = [
        "print(1)",
        f"import os, time; open({str(tmp_path / 'pid')!r}, 'w').write(str(os.getpid()));"
        "time.sleep(60)",
    ]
    going = LocalProcesses(processes=2).ended(tasks(tmp_path, *lines))
    assert next(going)[0] == 0
    while not (tmp_path / "pid").exists() or not (tmp_path / "pid").read_text():
        time.sleep(0.01)
    going.close()
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


def test_a_signal_that_ends_a_run_is_told(scripts, tmp_path):
    line = "import os, signal; print('t 3 s  step 4', flush=True); os.kill(os.getpid(), signal.{})"
    lines = [line.format(name) for name in ("SIGKILL", "SIGSEGV")]
    found = dict(LocalProcesses(processes=2).ended(tasks(tmp_path, *lines)))
    assert found[0].code == -9 and found[0].said.startswith("ended by SIGKILL, as is done with")
    assert found[1].said == "ended by SIGSEGV"


def test_last_words(tmp_path):
    task = Task((), tmp_path / "log")
    task.log.write_text("t 0 s\ncastx: not converged: no way\nadvice\n\n")
    assert last_words(task) == "not converged: no way"
    task.log.write_text("Killed\n")
    assert last_words(task) == "Killed"
    task.log.write_text("")
    assert last_words(task) == "no word"
