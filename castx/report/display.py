"""An invisible X server for pictures: VTK needs one even when it draws off-screen."""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager

from castx.errors import CaseError

SERVER_OPTIONS = ("-screen", "0", "2000x1600x24", "-nolisten", "tcp", "-noreset")
PR_SET_PDEATHSIG = 1
"""Option of prctl(2): the signal that a process gets when its parent dies."""


@contextmanager
def display() -> Iterator[None]:
    """Provide a display for VTK: a new server where Xvfb is installed, else that of the user.

    A new one is preferred, because VTK ends the whole process when DISPLAY names a server that does
    not answer. All plotters must be closed inside.

    Raises:
        CaseError: there is neither.
    """
    program = shutil.which("Xvfb")
    if program is None:
        if "DISPLAY" not in os.environ and os.name == "posix":
            raise CaseError(
                "pictures need an X server, and there is none; install Xvfb "
                "(Debian: apt install xvfb)"
            )
        yield
        return
    server, number = start_server(program)
    before = os.environ.get("DISPLAY")
    os.environ["DISPLAY"] = f":{number}"
    try:
        yield
    finally:
        if before is None:
            del os.environ["DISPLAY"]
        else:
            os.environ["DISPLAY"] = before
        server.terminate()
        server.wait()


def start_server(program: str) -> tuple[subprocess.Popen[bytes], str]:
    """Start Xvfb and return it with the number of its display once it answers.

    Raises:
        CaseError: it does not start.
    """
    reader, writer = os.pipe()
    server = subprocess.Popen(
        [program, "-displayfd", str(writer), *SERVER_OPTIONS],
        pass_fds=(writer,),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=die_with_parent,
    )
    os.close(writer)
    with os.fdopen(reader) as answer:
        number = answer.readline().strip()
    if not number:
        server.wait()
        raise CaseError("pictures need an X server, and Xvfb does not start; try by hand: Xvfb :9")
    return server, number


def die_with_parent() -> None:
    """Make this process end with the one that started it (Linux)."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
