"""Arrangement of one file with a header and named arrays: a zip file of .npy arrays (npz).

`numpy.load` opens it everywhere; each array carries a checksum (CRC-32), and what is inside stands
at the end of the file, so that one that was cut short is recognised. It is a single file and can be
replaced at once, which a folder cannot; and rows of submeshes, pairs and integration points need no
mesh in it. Where each array begins follows from names, types and shapes alone: all ranks know it
and write side by side, and the file is the same on any number of ranks.
"""

from __future__ import annotations

import io
import json
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, cast

from mpi4py import MPI

import numpy as np

from castx.checkpoint.checksums import shifted
from castx.checkpoint.chunks import ROWS

HEADER = "header.json"
FORMAT = 1
"""Number of this arrangement; others are not read."""
PAGE = 2**16
"""Bytes of a page of memory at most. Network file systems write whole pages, so that two ranks must
not write into one."""
PART = 2**24
"""Bytes that are read at once to be verified."""

_DAMAGES = (
    zipfile.BadZipFile, zlib.error, struct.error, ValueError, KeyError, TypeError, EOFError,
    SyntaxError, NotImplementedError, tokenize.TokenError,
)  # fmt: skip


@dataclass(frozen=True)
class ArchivedArray:
    """An array in an archive.

    Attributes:
        name: of the array.
        dtype: type of its values.
        shape: its shape.
        start: first byte of its .npy file in the archive.
        data: first byte of its values in the archive.
    """

    name: str
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    start: int
    data: int

    @property
    def count(self) -> int:
        """Number of rows."""
        return self.shape[0] if self.shape else 1

    @property
    def width(self) -> int:
        """Bytes of a row."""
        return self.dtype.itemsize * int(np.prod(self.shape[1:], dtype=np.int64))

    @property
    def end(self) -> int:
        """First byte behind the array."""
        return self.data + self.count * self.width

    def info(self, checksum: int) -> zipfile.ZipInfo:
        """Return the zip record of the .npy file with its checksum."""
        info = _info(self.name, checksum, self.end - self.start)
        info.header_offset = self.start - len(info.FileHeader(zip64=True))
        return info

    def head(self) -> bytes:
        """Return the beginning of the .npy file, before the values."""
        return _head(self.dtype, self.shape)


class Contents(NamedTuple):
    """Contents of an archive: header, places of the arrays and their checksums.

    Attributes:
        header: values beside the arrays.
        entries: places of the arrays by name.
        checksums: CRC-32 of each of their .npy files.
    """

    header: dict[str, Any]
    entries: dict[str, ArchivedArray]
    checksums: list[int]


def _info(name: str, checksum: int = 0, size: int = 0) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(f"{name}.npy")
    info.CRC = checksum
    info.file_size = info.compress_size = size
    return info


def _head(dtype: np.dtype[Any], shape: tuple[int, ...]) -> bytes:
    descr = np.lib.format.dtype_to_descr(dtype)
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        file, {"descr": descr, "fortran_order": False, "shape": shape}
    )
    return file.getvalue()


def arranged(arrays: Iterable[tuple[str, np.dtype[Any], tuple[int, ...]]]) -> list[ArchivedArray]:
    """Return the places of arrays, given by name, type and shape, in an archive.

    An array of several chunks begins and ends with a page.
    """
    entries: list[ArchivedArray] = []
    end = 0
    for name, dtype, shape in arrays:
        several = bool(shape) and shape[0] > ROWS
        head = len(_head(dtype, shape))
        data = end + len(_info(name).FileHeader(zip64=True)) + head
        data = _next_page(data) if several else data
        entries.append(ArchivedArray(name, dtype, shape, data - head, data))
        end = _next_page(entries[-1].end) if several else entries[-1].end
    return entries


def _next_page(place: int) -> int:
    return -(-place // PAGE) * PAGE


def write_contents(
    file: BinaryIO,
    entries: Sequence[ArchivedArray],
    checksums: Iterable[int],
    header: Mapping[str, Any],
) -> None:
    """Make an archive of a file that has the values of its arrays.

    Args:
        file: open for writing.
        entries: places of the arrays.
        checksums: CRC-32 of their values; in the same order.
        header: values beside the arrays, as JSON knows them.
    """
    names = [entry.name for entry in entries]
    file.seek(0)
    with zipfile.ZipFile(file, "w") as archive:
        for entry, checksum in zip(entries, checksums, strict=True):
            head = entry.head()
            info = entry.info(shifted(zlib.crc32(head), entry.end - entry.data) ^ checksum)
            file.seek(info.header_offset)
            file.write(info.FileHeader(zip64=True) + head)
            archive.filelist.append(info)
            archive.start_dir = max(archive.start_dir, entry.end)
        content = {"format": FORMAT, **header, "arrays": names}
        archive.writestr(zipfile.ZipInfo(HEADER), json.dumps(content, indent=1))  # without a time


def read_contents(path: Path) -> Contents:
    """Return the contents of an archive, checksums not verified.

    Raises:
        OSError, or one of `_DAMAGES`: the file cannot be read or is damaged.
    """
    with path.open("rb") as file, zipfile.ZipFile(file) as archive:
        header = dict(json.loads(archive.read(HEADER)))
        if header["format"] != FORMAT:
            raise ValueError(
                f"it has format {header['format']}, this version of castx reads {FORMAT}"
            )
        missing = {f"{name}.npy" for name in header["arrays"]} - set(archive.namelist())
        if missing:
            raise ValueError(f"it lacks {min(missing)}")
        found = {name: _entry(file, archive, name) for name in header["arrays"]}
    entries = {name: entry for name, (entry, _) in found.items()}
    return Contents(header, entries, [checksum for _, checksum in found.values()])


def _entry(file: BinaryIO, archive: zipfile.ZipFile, name: str) -> tuple[ArchivedArray, int]:
    """Return the place and the checksum of an array."""
    info = archive.getinfo(f"{name}.npy")
    with archive.open(info) as member:
        version = np.lib.format.read_magic(member)
        shape, is_fortran, dtype = np.lib.format.read_array_header_1_0(member)
        head = member.tell()
    file.seek(info.header_offset + 26)  # of the lengths of the name and of what follows it
    start = info.header_offset + 30 + sum(struct.unpack("<2H", file.read(4)))
    entry = ArchivedArray(name, dtype, shape, start, start + head)
    stored = info.compress_type == zipfile.ZIP_STORED and version == (1, 0) and not is_fortran
    if not stored or entry.end - start != info.file_size:
        raise ValueError(f"{info.filename} is not stored as castx does")
    return entry, info.CRC


def read_verified(path: Path, comm: MPI.Intracomm) -> Contents:
    """Return the contents of an archive after the ranks have verified its checksums; collective.

    Raises:
        ValueError: its fault; on all ranks.
    """
    found, fault = None, ""
    if comm.rank == 0:
        try:
            found = read_contents(path)
        except (*_DAMAGES, OSError) as error:
            fault = str(error) or type(error).__name__
    contents, fault = cast(tuple[Contents, str], comm.bcast((found, fault)))
    fault = fault or _wrong_checksum(path, contents, comm)
    if fault:
        raise ValueError(fault)
    return contents


def _wrong_checksum(path: Path, contents: Contents, comm: MPI.Intracomm) -> str:
    """Return the message of a wrong checksum, empty if all are right; each rank reads a part."""
    sums = np.zeros(len(contents.entries), dtype=np.int64)
    parts = (
        (number, entry, place)
        for number, entry in enumerate(contents.entries.values())
        for place in range(entry.start, entry.end, PART)
    )
    fault = ""
    try:
        with path.open("rb") as file:
            for number, entry, place in islice(parts, comm.rank, None, comm.size):
                file.seek(place)
                part = file.read(min(PART, entry.end - place))
                sums[number] ^= shifted(zlib.crc32(part), entry.end - place - len(part))
    except OSError as error:
        fault = error.strerror or str(error)
    comm.Allreduce(MPI.IN_PLACE, sums, MPI.BXOR)
    faults = [text for text in comm.allgather(fault) if text]
    names = zip(contents.entries, sums.tolist(), contents.checksums, strict=True)
    faults += [f"the checksum of {name}.npy is wrong" for name, a, b in names if a != b]
    return faults[0] if faults else ""
