"""Which tests a run leaves to others: to one rank, and to the run that has claimed their file."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

import pytest


def left_out(items: Iterable[pytest.Item], ranks: int) -> set[pytest.Item]:
    """Return the tests that do not run on this number of ranks.

    On several ranks these are the tests marked `serial`; on more than two also those marked
    `sampled`, except for the first set of parameters of each function.
    """
    found, seen = set(), set()
    for item in items:
        function = item.nodeid.partition("[")[0]
        if ranks > 1 and item.get_closest_marker("serial"):
            found.add(item)
        elif ranks > 2 and item.get_closest_marker("sampled") and function in seen:
            found.add(item)
        else:
            seen.add(function)
    return found


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
