"""Which tests a run leaves to `bin/test --all`, to one rank, or to the run that has their file."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import pytest

WHOLE_RUNS = (
    "tests/castx/app/",
    "tests/castx/case/",
    "tests/castx/command/",
    "tests/castx/coupling/",
    "tests/castx/process/",
    "tests/castx/proof/",
    "tests/castx/report/",
    "tests/castx/studies/",
    "tests/demos/",
    "tests/verification/",
)
"""Folders in which tests run whole cases, or ask what a second rank does."""
THREE_RANKS = ("tests/verification/test_coupled_checks.py",)
"""Whole runs on three ranks, where bodies and pairs meet more than one neighbour."""
LONGEST = (
    "tests/verification/test_independent_inverse.py",
    "tests/test_demos.py",
    "tests/verification/test_freezing_plate.py",
    "tests/verification/test_freezing_and_cooling.py",
    "tests/verification/test_v12_solidifying_slab.py",
    "tests/verification/test_closed_shells.py",
    "tests/castx/coupling/test_building.py",
    "tests/verification/test_clamped_die.py",
    "tests/verification/test_mush_flow.py",
    "tests/verification/test_cad_invariance.py",
)
"""The slowest files, by the last lines of `bin/test --all`."""


def longest_first(items: Iterable[pytest.Item]) -> list[pytest.Item]:
    """Return the tests with the slowest files in front, else in their order.

    Of two runs that share the files none then begins a long one when the other has no more.
    """
    place = {file: number for number, file in enumerate(LONGEST)}
    return sorted(items, key=lambda item: place.get(_file(item), len(place)))


def _file(item: pytest.Item) -> str:
    return item.nodeid.partition("::")[0]


def left_out(items: Iterable[pytest.Item], ranks: int, *, everything: bool) -> set[pytest.Item]:
    """Return the tests that do not run on this number of ranks.

    On several ranks only the rank contract runs, the tests marked `ranks`, each function with the
    first of its parameters. More than two ranks show what a third neighbour changes in an exchange:
    they leave out whole runs but the coupled checks. On one rank all tests run.

    Args:
        items: all tests that were found.
        ranks: number of ranks of this run.
        everything: whether tests marked `slow` run, and all parameters of those marked `sampled`.
    """
    found, seen = set(), set()
    for item in items:
        function = item.nodeid.partition("[")[0]
        if not _chosen(item, ranks, everything=everything, repeated=function in seen):
            found.add(item)
        else:
            seen.add(function)
    return found


def may_belong_to_contract(file: Path) -> bool:
    """Return whether a file of tests names the mark of the rank contract; others need no import."""
    return "mark.ranks" in file.read_text(encoding="utf-8")


def named_by_hand(arguments: Iterable[str]) -> bool:
    """Return whether the command line names single tests, which then run whatever their marks."""
    return any("::" in argument for argument in arguments)


def _chosen(item: pytest.Item, ranks: int, *, everything: bool, repeated: bool) -> bool:
    marked = item.get_closest_marker
    if marked("slow") and not everything:
        return False
    if ranks > 2 and item.nodeid.startswith(WHOLE_RUNS) and _file(item) not in THREE_RANKS:
        return False
    if ranks > 1:
        return bool(marked("ranks")) and not marked("serial") and not repeated
    return everything or not marked("sampled") or not repeated


def is_own(item: pytest.Item, folder: Path) -> bool:
    """Return whether this run has claimed the file of a test, or claims it now.

    Args:
        item: the test.
        folder: folder in which the runs that share the tests leave their claims.
    """
    claim = folder / _file(item).replace("/", ".")
    own = str(os.getpid())
    try:
        with claim.open("x") as file:
            file.write(own)
    except FileExistsError:
        return claim.read_text() == own
    return True
