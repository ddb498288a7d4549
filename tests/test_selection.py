"""Marks decide where a test runs, and runs that share the tests miss none."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

from tests import selection

PROJECT = Path(__file__).parents[1]
pytestmark = pytest.mark.serial

NAMES = (
    "a.py::one[1]",
    "a.py::one[2]",
    "a.py::two",
    "b.py::one[1]",
    "b.py::one[2]",
    "b.py::one[3]",
)


class Item:
    """A test with a name and markers."""

    def __init__(self, nodeid: str, *markers: str) -> None:
        self.nodeid, self.markers = nodeid, markers

    def get_closest_marker(self, name: str) -> bool:
        return name in self.markers


def names(items) -> set[str]:
    return {item.nodeid for item in items}


def test_on_several_ranks_runs_the_contract_with_the_first_parameters():
    items = [Item(name, *(["ranks"] if name.startswith("b") else [])) for name in NAMES]
    for ranks in (2, 3):
        for everything in (False, True):
            left = names(selection.left_out(items, ranks, everything=everything))
            assert left == set(NAMES) - {NAMES[3]}
    assert not selection.left_out(items, 1, everything=False)


def test_more_than_two_ranks_leave_out_whole_runs_but_the_coupled_checks():
    rooms = ["tests/castx/heat/test_body.py", "tests/castx/command/test_run.py",
             "tests/verification/test_v12.py", *selection.THREE_RANKS]  # fmt: skip
    items = [Item(f"{file}::one", "ranks") for file in rooms]
    assert not selection.left_out(items, 2, everything=True)
    left = selection.left_out(items, 3, everything=True)
    assert names_of_files(names(left)) == set(rooms[1:3])


def test_the_slowest_files_are_claimed_first_and_are_there():
    files = ["tests/a.py", selection.LONGEST[1], "tests/b.py", selection.LONGEST[0]]
    items = [Item(f"{file}::{test}") for file in files for test in ("two", "one")]
    order = [item.nodeid for item in selection.longest_first(items)]
    expected = [selection.LONGEST[0], selection.LONGEST[1], "tests/a.py", "tests/b.py"]
    assert order == [f"{file}::{test}" for file in expected for test in ("two", "one")]
    named = (*selection.LONGEST, *selection.THREE_RANKS, *selection.WHOLE_RUNS)
    assert all((PROJECT / file).exists() for file in named)


def test_files_that_do_not_name_the_mark_are_passed_over_on_several_ranks(tmp_path):
    files = [tmp_path / "test_a.py", tmp_path / "test_b.py"]
    files[0].write_text("@pytest.mark.ranks\ndef test(comm): ...\n")
    files[1].write_text("def test_any_number_of_ranks(comm): ...\n")
    assert [selection.may_belong_to_contract(file) for file in files] == [True, False]


def test_a_serial_test_is_never_in_the_contract():
    items = [Item(NAMES[0], "ranks", "serial"), Item(NAMES[1], "ranks")]
    assert names(selection.left_out(items, 2, everything=True)) == {NAMES[0]}


def test_slow_tests_run_with_everything_only():
    items = [Item(NAMES[0], "slow"), Item(NAMES[2], "slow", "ranks"), Item(NAMES[3], "ranks")]
    assert names(selection.left_out(items, 1, everything=False)) == {NAMES[0], NAMES[2]}
    assert not selection.left_out(items, 1, everything=True)
    assert names(selection.left_out(items, 2, everything=False)) == {NAMES[0], NAMES[2]}
    assert names(selection.left_out(items, 2, everything=True)) == {NAMES[0]}


def test_of_sampled_tests_the_first_runs_unless_everything_does():
    items = [Item(name, "sampled") for name in NAMES]
    left = names(selection.left_out(items, 1, everything=False))
    assert left == {NAMES[1], NAMES[4], NAMES[5]}
    assert not selection.left_out(items, 1, everything=True)


def test_what_is_named_by_hand_runs_whatever_its_marks():
    assert selection.named_by_hand(["-q", "tests/a.py::one"])
    assert not selection.named_by_hand(["-q", "tests/a.py"])


def test_each_file_is_run_by_the_one_that_claims_it_first(tmp_path, monkeypatch):
    runs: dict[int, list[str]] = {11: [], 12: []}
    for turn, name in enumerate((*NAMES, *reversed(NAMES))):
        number = 11 + (turn // 3) % 2
        monkeypatch.setattr(os, "getpid", lambda number=number: number)
        if selection.is_own(Item(name), tmp_path):
            runs[number].append(name)
    assert names_of_files(runs[11]) == {"a.py"} and names_of_files(runs[12]) == {"b.py"}


def test_a_file_that_another_run_has_claimed_leaves_the_others_as_they_are(tmp_path):
    files = ["tests/castx/input/test_units.py", "tests/castx/input/test_printable.py",
             "tests/castx/test_errors.py"]  # fmt: skip
    (tmp_path / files[1].replace("/", ".")).write_text("of another run")
    found = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *files],
        env={**os.environ, "CASTX_TEST_CLAIMS": str(tmp_path)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stdout


TWICE = """
import subprocess, sys, pytest
pytest.main(sys.argv[1:])
subprocess.run([sys.executable, "-m", "pytest", *sys.argv[1:]])
"""
"""A run of pytest whose process starts another one, as tests of the tests do."""


def test_a_run_that_a_test_starts_claims_nothing_and_leaves_nothing_out(tmp_path):
    file = "tests/castx/test_errors.py"
    found = subprocess.run(
        [sys.executable, "-c", TWICE, "-q", "-p", "no:cacheprovider", file],
        env={**os.environ, "CASTX_TEST_CLAIMS": str(tmp_path)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    first, second = re.findall(r"(\d+) passed", found.stdout)
    assert first == second, found.stdout
    assert [path.name for path in tmp_path.iterdir()] == [file.replace("/", ".")]


def names_of_files(tests: Iterable[str]) -> set[str]:
    return {name.partition("::")[0] for name in tests}
