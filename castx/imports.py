"""Imports without a search for garbage.

What a command imports makes some million objects, nearly all of which stay to the end. Python
searches them for garbage again and again while they are made, and once more when it ends: a third
of the time of both.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def unsearched() -> Iterator[None]:
    """Import without a search for garbage; afterwards all is as it was."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


@contextmanager
def kept() -> Iterator[None]:
    """Import without a search for garbage, and leave what is there out of all later ones.

    For a process that is a command: whatever exists then is taken to stay to its end.
    """
    with unsearched():
        yield
        gc.freeze()
