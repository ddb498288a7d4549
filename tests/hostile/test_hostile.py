"""Hostile input is refused with exit code 2 and words, in 5 s and 500 MB, on any number of ranks.

Every entry of the corpus has brought castx or what it stands on down, hung it, or filled memory or
terminal. Those that endanger the process get one of their own, whose memory is measured: that of
all its processes' largest, less that of `castx check` of a good case.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from functools import cache
from pathlib import Path

import pytest

from castx.command.cli import execute
from tests.castx.command_line import start
from tests.hostile.corpus import ENTRIES, HEAVY, check

pytestmark = [pytest.mark.serial, pytest.mark.timeout(90)]

LONGEST = 5.0
"""Time for a refusal [s], without that of the start."""
MOST = 500e6
"""Memory for a refusal [bytes], without that of the start."""
OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")
"""Characters that terminals obey."""


@pytest.mark.sampled
@pytest.mark.parametrize("name", sorted(set(ENTRIES) - HEAVY))
def test_refused(comm, name, tmp_path, capfd):
    arguments, pattern = ENTRIES[name](tmp_path)
    for _ in range(2):  # a machine that was busy elsewhere may try once more
        begin = time.monotonic()
        code = execute(arguments, comm)
        took = time.monotonic() - begin
        captured = capfd.readouterr()
        judge(code, captured.out + captured.err, pattern)
        if took < LONGEST:
            return
    raise AssertionError(f"took {took:.1f} s, more than {LONGEST:g} s")


@pytest.mark.sampled
@pytest.mark.parametrize("name", sorted(HEAVY))
def test_refused_by_a_process_of_its_own(name, tmp_path):
    usual, usual_time = cost_of_a_good_case(tmp_path)
    arguments, pattern = ENTRIES[name](tmp_path)
    code, text, memory, took = run(tmp_path, arguments)
    judge(code, text, pattern)
    assert memory - usual < MOST
    assert took - usual_time < LONGEST


@pytest.mark.sampled
@pytest.mark.parametrize("name", ["xdmf_that_meshio_exits_for", "vtu_negative_point"])
def test_two_ranks_refuse_together(name, tmp_path):
    arguments, pattern = ENTRIES[name](tmp_path)
    process = start("mpirun", "-n", "2", sys.executable, "-m", "castx", *arguments)
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 2
    assert re.search(pattern, output + errors)


def judge(code: int, text: str, pattern: str) -> None:
    shown = text[:3000]
    assert code == 2, shown
    assert re.search(pattern, " ".join(text.split())), shown
    assert "Traceback" not in text, shown
    assert not OBEYED.search(text), ascii(shown)
    assert len(text) < 10_000, shown


def run(folder: Path, arguments: list[str]) -> tuple[int, str, float, float]:
    """Run castx; return its exit code, all it says, its largest memory [bytes] and its time [s]."""
    begin = time.monotonic()
    with (folder / "said").open("wb") as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "castx", *arguments], stdout=said, stderr=said, cwd=folder
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    text = (folder / "said").read_text(errors="replace")
    return process.returncode, text, 1024.0 * usage.ru_maxrss, time.monotonic() - begin


@cache
def cost_of_a_good_case_once(folder: Path) -> tuple[float, float]:
    code, text, memory, took = run(folder, check(folder))
    assert code == 0, text
    return memory, took


def cost_of_a_good_case(folder: Path) -> tuple[float, float]:
    return cost_of_a_good_case_once(folder.parent)
