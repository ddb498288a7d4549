"""The folder of a run: refused before anything is solved when it cannot take results."""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpi4py import MPI

from castx.errors import CaseError
from castx.results.files.lock import FILE as LOCK
from castx.results.files.lock import FolderLock

if TYPE_CHECKING:
    from castx.case.case import Case

RECORD = "run.json"
SERIES = ("probes.csv", "history.csv")
REPORT = "report.html"
FIELDS = "fields"
COLLECTION = "castx.pvd"
CHECKPOINT = "checkpoint"
CURE = "choose another one with output.folder or --output"


@contextmanager
def claimed_folder(case: Case, comm: MPI.Intracomm) -> Iterator[Path]:
    """Hold the results folder of a case, which is made if it does not exist; collective.

    Nothing in it is touched yet. Results of an earlier run of the case may be written over; those
    of another case, files of somebody else and a folder in use are refused.

    Raises:
        CaseError: on all ranks, when the folder cannot take the results.
    """
    folder = case.output.folder
    lock: FolderLock | None = None
    refusal, made = None, False
    if comm.rank == 0:
        made = not folder.exists()
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
        return f"the output folder {folder} cannot be written: {error.strerror or error}; {CURE}"
    if holder is None:
        return None
    return (
        f"the output folder {folder} is in use by {holder}; wait for it, or {CURE} (if that run is "
        f"dead, delete {folder / LOCK})"
    )


def refusal_of(folder: Path, case: Case) -> str | None:
    """Return why a folder cannot take the results of a case, or None when it can."""
    if folder.exists() and not folder.is_dir():
        return f"the output folder {folder} is a file; {CURE}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        return f"the output folder {folder} cannot be written: {error.strerror or error}; {CURE}"
    record = record_of(folder)
    if record is None:
        if all(is_left_over(path) for path in folder.iterdir()):
            return None
        return (
            f"the output folder {folder} holds files that are not results of castx (no {RECORD}); "
            f"{CURE}"
        )
    if belongs_to(record, case):
        return None
    return (
        f"the output folder {folder} holds results of another case, {other_case(record)}; {CURE}, "
        "or delete the folder"
    )


def is_left_over(path: Path) -> bool:
    """Return whether a file is what a run leaves that was killed before it had a record."""
    return path.name == LOCK or path.name.startswith(f".{RECORD}.")


def record_of(folder: Path) -> dict[str, Any] | None:
    """Return the record of the run whose results a folder holds, None if it holds none."""
    try:
        record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return record if isinstance(record, dict) and "castx" in record else None


def belongs_to(record: dict[str, Any], case: Case) -> bool:
    """Return whether a record is that of a case: of the same file, or of the same content."""
    known = record.get("case")
    if not isinstance(known, dict):
        return True
    return known.get("file") == str(case.path.resolve()) or known.get("digest") == case.digest


def other_case(record: dict[str, Any]) -> str:
    """Return how the case of a record is called."""
    known = record["case"]
    return f"{known.get('name', '')!r} ({known.get('file', 'no file')})"


def clear_results(folder: Path) -> None:
    """Remove the results of an earlier run and leave everything else in the folder."""
    for name in (*SERIES, REPORT):
        (folder / name).unlink(missing_ok=True)
    ours = ((FIELDS, "*.vtu"), (FIELDS, "*.pvd"), (CHECKPOINT, "state.npz*"), ("", f".{RECORD}.*"))
    for place, pattern in ours:
        for path in (folder / place).glob(pattern):
            path.unlink()
    remove_if_empty(folder / CHECKPOINT)


def remove_if_empty(folder: Path) -> None:
    """Remove a folder that holds nothing."""
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()


def write_whole(path: Path, text: str) -> None:
    """Write a text file so that a reader finds the old one or the whole new one, never a part."""
    aside = path.with_name(f".{path.name}.{os.getpid()}.{time.monotonic_ns()}")
    try:
        aside.write_text(text, encoding="utf-8")
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)
