"""The lock of a results folder: two runs at the same time would destroy each other's results.

The kernel gives the lock back when its process ends, however it ends, so that what a killed run
leaves behind never stands in the way. Where a file system cannot lock, process and host decide.
"""

from __future__ import annotations

import errno
import fcntl
import json
import os
import socket
from pathlib import Path
from typing import Any, TextIO

FILE = ".lock"
_HELD = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)


class FolderLock:
    """Holds a results folder for this process; used on rank 0 only.

    Args:
        folder: an existing folder.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / FILE
        self._file: TextIO | None = None

    def acquire(self) -> str | None:
        """Take the lock; return None, or who holds it."""
        while True:
            file = self._path.open("a+", encoding="utf-8")
            holder = _holder(file)
            if holder is not None:
                file.close()
                return holder
            if self._is_current(file):
                break
            file.close()  # its holder has just removed it
        self._file = file
        file.truncate(0)
        file.write(json.dumps(own_identity()))
        file.flush()
        return None

    def _is_current(self, file: TextIO) -> bool:
        try:
            return os.path.samestat(os.fstat(file.fileno()), self._path.stat())
        except FileNotFoundError:
            return False

    def release(self) -> None:
        """Give the lock back."""
        if self._file is not None:
            self._path.unlink(missing_ok=True)
            self._file.close()
            self._file = None


def own_identity() -> dict[str, Any]:
    """Return what tells this process from others: its number counts in its own namespace only."""
    return {
        "process": os.getpid(),
        "host": socket.gethostname(),
        "namespace": os.readlink("/proc/self/ns/pid") if Path("/proc/self/ns/pid").exists() else "",
    }


def _holder(file: TextIO) -> str | None:
    """Lock an open file; return None, or who holds it."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        identity = _read_identity(file)
        if error.errno not in _HELD and not _may_live(identity):
            return None
        return f"process {identity.get('process', '?')} on {identity.get('host', '?')}"
    return None


def _read_identity(file: TextIO) -> dict[str, Any]:
    file.seek(0)
    try:
        identity = json.load(file)
    except ValueError:
        return {}
    return identity if isinstance(identity, dict) else {}


def _may_live(identity: dict[str, Any]) -> bool:
    """Return whether the process of a lock may still run, as far as can be seen from here."""
    own = own_identity()
    if not identity:
        return False
    if any(identity.get(key) != own[key] for key in ("host", "namespace")):
        return True
    process = identity.get("process")
    return process != own["process"] and Path(f"/proc/{process}").exists()
