"""One file with a header and named arrays, on one rank: a zip file of .npy arrays (npz).

`numpy.load` opens it everywhere; each array carries a checksum (CRC-32), and what is inside stands
at the end of the file, so that one that was cut short is recognised. It is a single file and can be
replaced at once, which a folder cannot; and rows of submeshes, pairs and integration points need no
mesh in it.
"""

from __future__ import annotations

import json
import os
import zipfile
import zlib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from castx.errors import CaseError
from castx.stateful import Array

HEADER = "header.json"
NEW = ".new"
FORMAT = 1
"""Number of this arrangement of files; others are not read."""

_DAMAGES = (zipfile.BadZipFile, zlib.error, ValueError, KeyError, EOFError, NotImplementedError)


class ArchiveWriter:
    """Writes an archive beside the one it replaces.

    Leaving it makes sure that all is on disk, reads it back and only then replaces the old file;
    after an error the old one stays.

    Args:
        path: the file.
        header: values beside the arrays, as JSON knows them.

    Raises:
        OSError: the disk does not take it, or does not give it back.
    """

    def __init__(self, path: Path, header: Mapping[str, Any]) -> None:
        self._path, self._new = path, path.with_name(path.name + NEW)
        self._header = {"format": FORMAT, **header}
        self._names: list[str] = []

    def __enter__(self) -> Self:
        self._file = self._new.open("wb")
        self._zip = zipfile.ZipFile(self._file, "w")
        return self

    def add(self, name: str, array: Array) -> None:
        """Write an array."""
        self._names.append(name)
        with self._zip.open(f"{name}.npy", "w", force_zip64=True) as member:
            np.lib.format.write_array(member, array, allow_pickle=False)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        try:
            if error is None:
                self._finish()
        finally:
            self._new.unlink(missing_ok=True)
            with suppress(OSError, ValueError):  # after an error it tries to write again
                self._zip.close()
            with suppress(OSError):
                self._file.close()

    def _finish(self) -> None:
        self._zip.writestr(HEADER, json.dumps({**self._header, "arrays": self._names}, indent=1))
        self._zip.close()
        self._file.flush()
        os.fsync(self._file.fileno())
        fault = fault_of(self._new)
        if fault is not None:
            raise OSError(f"what was written does not read back: {fault}")
        self._new.replace(self._path)
        sync_folder(self._path.parent)


def sync_folder(folder: Path) -> None:
    """Bring the names in a folder to disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def fault_of(path: Path) -> str | None:
    """Return the fault of an archive in its header or a checksum, None if it is whole."""
    try:
        with zipfile.ZipFile(path) as archive:
            header = _header(archive)
            missing = {f"{name}.npy" for name in header["arrays"]} - set(archive.namelist())
            if missing:
                return f"it lacks {min(missing)}"
            damaged = archive.testzip()
    except (*_DAMAGES, OSError) as error:
        return str(error) or type(error).__name__
    return None if damaged is None else f"the checksum of {damaged} is wrong"


def _header(archive: zipfile.ZipFile) -> dict[str, Any]:
    header = json.loads(archive.read(HEADER))
    if header["format"] != FORMAT:
        raise ValueError(f"it has format {header['format']}, this version of castx reads {FORMAT}")
    return dict(header)


def read_header(path: Path) -> dict[str, Any]:
    """Return the header of an archive whose checksums have all been verified.

    Raises:
        CaseError: the file cannot be read or is damaged.
    """
    fault = fault_of(path)
    if fault is not None:
        raise CaseError(
            f"the checkpoint {path} is damaged: {fault}; put a whole copy in its place, or start "
            "the run anew without --restart"
        )
    with zipfile.ZipFile(path) as archive:
        return _header(archive)


def read_array(path: Path, name: str) -> Array:
    """Return an array of an archive."""
    with zipfile.ZipFile(path) as archive, archive.open(f"{name}.npy") as member:
        return np.lib.format.read_array(member, allow_pickle=False)
