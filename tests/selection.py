"""Which tests a run leaves to `bin/test --all`, to one rank, or to the run that has their file."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import pytest


def left_out(items: Iterable[pytest.Item], ranks: int, *, everything: bool) -> set[pytest.Item]:
    """Return the tests that do not run on this number of ranks.

    On several ranks only the rank contract runs, the tests marked `ranks`, each function with the
    first of its parameters. On one rank all tests run.

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


def named_by_hand(arguments: Iterable[str]) -> bool:
    """Return whether the command line names single tests, which then run whatever their marks."""
    return any("::" in argument for argument in arguments)


def _chosen(item: pytest.Item, ranks: int, *, everything: bool, repeated: bool) -> bool:
    marked = item.get_closest_marker
    if marked("slow") and not everything:
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
    claim = folder / item.nodeid.partition("::")[0].replace("/", ".")
    own = str(os.getpid())
    try:
        with claim.open("x") as file:
            file.write(own)
    except FileExistsError:
        return claim.read_text() == own
    return True
