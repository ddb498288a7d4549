"""Markers decide on how many ranks a test runs, and runs that share the tests miss none."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests import selection

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


def test_serial_tests_run_on_one_rank_only():
    items = [Item(name, *(["serial"] if name.startswith("b") else [])) for name in NAMES]
    assert not selection.left_out(items, 1)
    for ranks in (2, 3):
        assert names(selection.left_out(items, ranks)) == set(NAMES[3:])


def test_of_sampled_tests_the_first_that_is_not_serial_runs_on_more_than_two_ranks():
    items = [Item(name, "sampled") for name in NAMES[:4]]
    items += [Item(NAMES[4], "sampled", "serial"), Item(NAMES[5], "sampled")]
    items[3].markers = ("sampled", "serial")
    assert names(selection.left_out(items, 2)) == set(NAMES[3:5])
    assert names(selection.left_out(items, 3)) == {NAMES[1], NAMES[3], NAMES[4]}


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


def names_of_files(tests: list[str]) -> set[str]:
    return {name.partition("::")[0] for name in tests}
