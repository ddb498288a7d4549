"""Signals that ask a process with PETSc to end: they end it as any other, or not under nohup."""

import signal
import subprocess
import sys

import pytest

pytestmark = pytest.mark.serial

ASKED = """
import os, signal, sys
number = signal.Signals(int(sys.argv[1]))
if len(sys.argv) > 2:
    signal.signal(number, signal.SIG_IGN)
    os.execv(sys.executable, [sys.executable, sys.argv[2], sys.argv[1]])
import castx
from mpi4py import MPI
from petsc4py import PETSc
PETSc.Vec().createSeq(1).destroy()
os.kill(os.getpid(), number)
print("alive")
"""


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGTERM])
@pytest.mark.parametrize("ignored", [False, True])
def test_a_process_ends_as_the_signal_asks(tmp_path, number, ignored):
    program = tmp_path / "asked.py"
    program.write_text(ASKED)
    more = [str(program)] if ignored else []
    command = [sys.executable, str(program), str(int(number)), *more]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    expected = (0, "alive\n") if ignored else (-number, "")
    assert (ended.returncode, ended.stdout) == expected, ended.stderr
