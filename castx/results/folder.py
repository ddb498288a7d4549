"""The folder of a run: refused before anything is solved when it cannot take results."""

from __future__ import annotations

import json
import os
import tempfile
import time
from pathlib import Path

from mpi4py import MPI

from castx.errors import CaseError

RECORD = "run.json"
SERIES = ("probes.csv", "history.csv")
REPORT = "report.html"
FIELDS = "fields"
CURE = "choose another one with output.folder or --output"


def claim_folder(folder: Path, comm: MPI.Intracomm) -> None:
    """Make sure that results can be written to a folder, which is made if it does not exist.

    Nothing in it is touched yet. Results of an earlier run may be written over; a folder that holds
    anything else without being a results folder is refused.

    Raises:
        CaseError: on all ranks, when the folder cannot be written or holds files of somebody else.
    """
    refusal = refusal_of(folder) if comm.rank == 0 else None
    refusal = comm.bcast(refusal)
    if refusal is not None:
        raise CaseError(refusal)


def refusal_of(folder: Path) -> str | None:
    """Return why a folder cannot take results, or None when it can."""
    if folder.exists() and not folder.is_dir():
        return f"the output folder {folder} is a file; {CURE}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        return f"the output folder {folder} cannot be written: {error.strerror or error}; {CURE}"
    if any(folder.iterdir()) and not holds_results(folder):
        return (
            f"the output folder {folder} holds files that are not results of castx (no {RECORD}); "
            f"{CURE}"
        )
    return None


def holds_results(folder: Path) -> bool:
    """Return whether a folder holds the results of a run of castx, finished or not."""
    try:
        record = json.loads((folder / RECORD).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(record, dict) and "castx" in record


def clear_results(folder: Path) -> None:
    """Remove the results of an earlier run and leave everything else in the folder."""
    for name in (*SERIES, REPORT):
        (folder / name).unlink(missing_ok=True)
    for pattern in ("*.vtu", "*.pvd"):
        for piece in (folder / FIELDS).glob(pattern):
            piece.unlink()


def write_whole(path: Path, text: str) -> None:
    """Write a text file so that a reader finds the old one or the whole new one, never a part."""
    aside = path.with_name(f".{path.name}.{os.getpid()}.{time.monotonic_ns()}")
    aside.write_text(text, encoding="utf-8")
    aside.replace(path)
