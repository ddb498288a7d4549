"""The folder of a run: refused before anything is solved when it cannot take results, and locked.

Two runs at the same time would destroy each other's results. The kernel releases the lock when its
process ends, however it ends, so that what a killed run leaves behind never stands in the way.
Where a file system cannot lock, process and host decide.
"""

from __future__ import annotations

import errno
import fcntl
import json
import logging
import os
import socket
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from mpi4py import MPI

from castx.errors import CaseError, StorageError
from castx.results.files.run_json import read_record

if TYPE_CHECKING:
    from castx.case.case import Case

RECORD = "run.json"
CASE = "case.json"
PROBES, HISTORY = "probes.csv", "history.csv"
SERIES = (PROBES, HISTORY)
HOT_SPOTS = "hot_spots.csv"
MEASURED = "measurements.csv"
REPORT = "report.html"
SENSITIVITY = "sensitivity.json"
ESTIMATE = "estimate.json"
FIELDS = "fields"
COLLECTION = "castx.pvd"
ENDING = ".hdf"
"""Of the file of a body in VTKHDF, after its name; ParaView and pyvista know it."""
CHECKPOINT = "checkpoint"
LOCK = ".lock"
OURS = (
    LOCK, RECORD, CASE, *SERIES, HOT_SPOTS, MEASURED, REPORT, SENSITIVITY, ESTIMATE, FIELDS,
    CHECKPOINT,
)  # fmt: skip
CURE = "choose another one with output.folder or --output"
PATIENCE = 1.0
"""Time for the holder of a lock to say who it is [s]."""
log = logging.getLogger(__name__)
_HELD = (errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES)


@contextmanager
def claimed_folder(case: Case, comm: MPI.Intracomm) -> Iterator[Path]:
    """Lock the results folder of a case, which is created if it does not exist; collective.

    Nothing in it is touched yet. Results of an earlier run of the case are kept aside later; those
    of another case, files of somebody else and a folder in use are refused.

    Raises:
        CaseError: on all ranks, when the folder cannot take the results.
    """
    folder = case.output.folder
    lock: FolderLock | None = None
    refusal, made = None, False
    if comm.rank == 0:
        made = not os.path.lexists(folder)  # also of names that are too long
        refusal = refusal_of(folder, case)
        if refusal is None:
            lock = FolderLock(folder)
            refusal = refusal_of_lock(folder, lock)
    refusal = comm.bcast(refusal)
    if refusal is not None:
        raise CaseError(refusal)
    try:
        yield folder
    finally:
        if lock is not None:
            lock.release()
            if made:
                remove_if_empty(folder)


def claim_folder(case: Case, comm: MPI.Intracomm) -> None:
    """Make sure that the results of a case can be written to its folder; collective.

    Raises:
        CaseError: on all ranks, when the folder cannot take the results.
    """
    refusal = refusal_of(case.output.folder, case) if comm.rank == 0 else None
    refusal = comm.bcast(refusal)
    if refusal is not None:
        raise CaseError(refusal)


def refusal_of_lock(folder: Path, lock: FolderLock) -> str | None:
    """Take a lock; return None, or why that is not possible."""
    try:
        holder = lock.acquire()
    except OSError as error:
        return f"the output folder {folder} cannot be written: {reason_of(error)}; {CURE}"
    if holder is None:
        return None
    return (
        f"the output folder {folder} is in use by {holder}; wait for it, or {CURE} (if that run is "
        f"dead, delete {folder / LOCK})"
    )


def reason_of(error: Exception) -> str:
    """Return why a file cannot be used, in the words of the system."""
    return getattr(error, "strerror", None) or str(error)


def refusal_of(folder: Path, case: Case) -> str | None:
    """Return why a folder cannot take the results of a case, or None when it can."""
    if os.path.exists(folder) and not os.path.isdir(folder):
        return f"the output folder {folder} is a file; {CURE}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, ValueError) as error:
        return f"the output folder {folder} cannot be written: {reason_of(error)}; {CURE}"
    link = next((name for name in OURS if (folder / name).is_symlink()), None)
    if link is not None:
        return (
            f"the output folder {folder} holds a symbolic link, {link}: what it leads to would be "
            f"written over; replace it by what it leads to, or {CURE} (which may be a link as a "
            "whole)"
        )
    record = record_of(folder)
    if record is None:
        if all(is_left_over(path) for path in folder.iterdir()):
            return None
        why = f"{RECORD} is not one of castx" if (folder / RECORD).exists() else f"no {RECORD}"
        return (
            f"the output folder {folder} holds files that are not results of castx ({why}); {CURE}"
        )
    if belongs_to(record, case):
        return None
    return (
        f"the output folder {folder} holds results of another case, {other_case(record)}; {CURE}, "
        "or delete the folder"
    )


def is_left_over(path: Path) -> bool:
    """Return whether a file was left by a run that was killed before it had a record."""
    return path.name == LOCK or path.name.startswith(f".{RECORD}.")


def record_of(folder: Path) -> dict[str, Any] | None:
    """Return the record of the run whose results are in a folder, None if there are none."""
    try:
        record = read_record(folder / RECORD)
    except CaseError:
        return None
    return record if "castx" in record else None


def belongs_to(record: dict[str, Any], case: Case) -> bool:
    """Return whether a record has the file or the content of a case."""
    known = record.get("case")
    if not isinstance(known, dict):
        return True
    return known.get("file") == str(case.path.resolve()) or known.get("digest") == case.digest


def other_case(record: dict[str, Any]) -> str:
    """Return name and file of the case of a record."""
    known = record["case"]
    return f"{known.get('name', '')!r} ({known.get('file', 'no file')})"


def keep_results(folder: Path) -> Path | None:
    """Move the results of an earlier run aside; return where they are, None if there were none.

    They go into a folder beside this one, `NAME.1`, `NAME.2` …, or into it where none can be made
    there or another disk would have to take them. Other files stay.

    Args:
        folder: of the results; a link to one leads to the folder beside which they are kept.
    """
    ours = [name for name in OURS if name != LOCK and (folder / name).exists()]
    if record_of(folder) is None or not {*SERIES, FIELDS, CHECKPOINT} & set(ours):
        return None
    aside = _numbered(folder.resolve().with_name, folder.resolve().name, folder)
    if aside is None:
        aside = _numbered(folder.joinpath, "earlier", folder)
    if aside is None:
        raise OSError(errno.EACCES, f"the results in {folder} cannot be kept aside")
    for name in ours:
        (folder / name).rename(aside / name)
    return aside


def _numbered(place: Callable[[str], Path], name: str, beside: Path) -> Path | None:
    """Return a new folder `name.1`, `name.2` … on the disk of another one, None if it cannot be."""
    number = 1
    while True:
        made = place(f"{name}.{number}")
        try:
            made.mkdir()
        except FileExistsError:
            number += 1
            continue
        except OSError:
            return None
        if made.stat().st_dev == beside.stat().st_dev:
            return made
        made.rmdir()
        return None


def make_room(folder: Path) -> None:
    """Keep the results of an earlier run aside, and say where."""
    aside = keep_results(folder)
    if aside is not None:
        log.info("the results of the earlier run are kept in %s", aside)
    clear_results(folder)


def clear_results(folder: Path) -> None:
    """Remove the results of an earlier run and leave everything else in the folder."""
    for name in (CASE, *SERIES, HOT_SPOTS, MEASURED, REPORT, SENSITIVITY, ESTIMATE):
        (folder / name).unlink(missing_ok=True)
    ours = (
        (FIELDS, f"*{ENDING}"), (FIELDS, f".*{ENDING}.*"), (FIELDS, "*.vtu"), (FIELDS, "*.pvd"),
        (CHECKPOINT, "state.npz*"), ("", f".{RECORD}.*"), ("", f".{CASE}.*"),
    )  # fmt: skip
    for place, pattern in ours:
        for path in (folder / place).glob(pattern):
            path.unlink()
    remove_if_empty(folder / CHECKPOINT)


def remove_if_empty(folder: Path) -> None:
    """Remove an empty folder."""
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()


def write_whole(path: Path, text: str) -> None:
    """Write a text file so that a reader finds the old one or the whole new one, never a part."""
    new = path.with_name(f".{path.name}.{os.getpid()}.{time.monotonic_ns()}")
    try:
        new.write_text(text, encoding="utf-8")
        new.replace(path)
    finally:
        new.unlink(missing_ok=True)


def store_text(path: Path, text: str) -> None:
    """Write a text file as `write_whole` does; on one rank, of no run that others take part in.

    Raises:
        StorageError: it cannot be written; with the file and the reason.
    """
    try:
        write_whole(path, text)
    except OSError as error:
        raise StorageError(
            f"cannot write {path}: {reason_of(error)}; make room or give permission there, or copy "
            "the folder to a place with both"
        ) from error


class FolderLock:
    """Lock of a results folder for this process; used on rank 0 only.

    Args:
        folder: an existing folder.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / LOCK
        self._file: TextIO | None = None

    def acquire(self) -> str | None:
        """Take the lock; return None, or its owner in words."""
        while True:
            file = self._opened()
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

    def _opened(self) -> TextIO:
        """Open the file itself, never the target of a link nor a pipe."""
        flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
        descriptor = os.open(self._path, flags, 0o666)
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode) or found.st_nlink > 1:
            os.close(descriptor)
            what = "has another name too" if stat.S_ISREG(found.st_mode) else "is no file"
            raise OSError(errno.EINVAL, f"{self._path.name} {what}")
        return os.fdopen(descriptor, "r+", encoding="utf-8")

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
    """Return process, host and namespace: a process number is unique in its namespace only."""
    return {
        "process": os.getpid(),
        "host": socket.gethostname(),
        "namespace": os.readlink("/proc/self/ns/pid") if Path("/proc/self/ns/pid").exists() else "",
    }


def _holder(file: TextIO) -> str | None:
    """Lock an open file; return None, or the owner of its lock in words."""
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        identity = _read_identity(file)
        if error.errno not in _HELD and not _may_live(identity):
            return None
        if not identity:
            return "another run that has just begun"
        return f"process {identity.get('process')} on {identity.get('host')}"
    return None


def _read_identity(file: TextIO) -> dict[str, Any]:
    """Return who holds a lock; its holder writes that a moment after it has taken it."""
    end = time.monotonic() + PATIENCE
    while True:
        file.seek(0)
        try:
            identity = json.load(file)
            return identity if isinstance(identity, dict) else {}
        except ValueError:
            if time.monotonic() > end:
                return {}
            time.sleep(PATIENCE / 20)


def _may_live(identity: dict[str, Any]) -> bool:
    """Return whether the process of a lock may still run, as far as can be seen from here."""
    own = own_identity()
    if not identity:
        return False
    if any(identity.get(key) != own[key] for key in ("host", "namespace")):
        return True
    process = identity.get("process")
    return process != own["process"] and Path(f"/proc/{process}").exists()
