"""HDF5 data sets that grow by a block of rows with every step, and the failures of their file.

What a step appends is in the file before anything counts the step, so that a file whose writer was
killed is that of the steps before. Its place follows from the counted steps alone: what a killed
writer left behind them is written over.
"""

from __future__ import annotations

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import numpy.typing as npt

COMPRESSION = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
"""Of what is large; VTK has its inverse everywhere."""
STEPS_IN_CHUNK = 64
"""Steps whose numbers lie in one piece of the file."""
ABSENT = "absent"
"""Attribute of a data set: first row of its block without numbers, for steps without the field."""


def grown(group: h5py.Group, name: str, rows: int, like: npt.NDArray[Any]) -> h5py.Dataset:
    """Return a new data set without rows that grows by blocks.

    Args:
        group: to which it belongs.
        name: its name there.
        rows: of a block.
        like: an array of its type and columns.
    """
    width = like.shape[1:]
    return group.create_dataset(
        name, (0, *width), like.dtype, maxshape=(None, *width), chunks=(rows, *width), **COMPRESSION
    )


def step_numbers(group: h5py.Group, name: str, like: Any) -> h5py.Dataset:
    """Return a new data set with a number, or a row of numbers, for each step.

    Args:
        group: to which it belongs.
        name: its name there.
        like: the entry of a step, as an array.
    """
    entry = np.asarray(like)
    shape = (STEPS_IN_CHUNK, *entry.shape)
    return group.create_dataset(
        name, (0, *entry.shape), entry.dtype, maxshape=(None, *entry.shape), chunks=shape
    )


def set_step(numbers: h5py.Dataset, step: int, entry: Any) -> None:
    """Write the number of a step; those that lack before it are zero."""
    if len(numbers) <= step:
        numbers.resize(step + 1, axis=0)
    numbers[step] = entry


def append_block(
    data: h5py.Dataset, offsets: h5py.Dataset, step: int, values: npt.NDArray[Any] | None, rows: int
) -> None:
    """Write the block of a step behind those of the steps before it, and where it begins.

    Args:
        data: the data set.
        offsets: the first rows of the blocks of all steps.
        step: number of the step, from zero.
        values: the block; None: the step lacks the field, and shares one without numbers.
        rows: of a block.
    """
    before = offsets[:step]
    start = int(before.max()) + rows if step else 0
    absent = absent_block(data, before)
    if values is None and absent is not None:
        set_step(offsets, step, absent)
        return
    if len(data) < start + rows:
        data.resize(start + rows, axis=0)
    data[start : start + rows] = np.nan if values is None else values
    if values is None:
        data.attrs[ABSENT] = start
    elif absent is None and ABSENT in data.attrs:
        del data.attrs[ABSENT]
    set_step(offsets, step, start)


def absent_block(data: h5py.Dataset, offsets: npt.NDArray[Any]) -> int | None:
    """Return the first row of the block without numbers, None where none of the steps has it."""
    found = data.attrs.get(ABSENT)
    return None if found is None or found not in offsets else int(found)


def is_grown(data: object, steps: int = 0) -> bool:
    """Return whether an object of a file is a data set of numbers that grows.

    Args:
        data: the object.
        steps: rows that it has at least.
    """
    return (
        isinstance(data, h5py.Dataset)
        and data.dtype.kind in "fiu"
        and data.ndim > 0
        and data.maxshape[0] is None
        and len(data) >= steps
    )


def need_room(folder: Path, size: int) -> None:
    """Refuse to write to a disk that cannot take it: HDF5 would leave a damaged file.

    Args:
        folder: on the disk.
        size: what will be written at most [bytes].

    Raises:
        OSError: the disk is full.
    """
    if shutil.disk_usage(folder).free < size:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder))


@contextmanager
def opened(path: Path, mode: str) -> Iterator[h5py.File]:
    """Open an HDF5 file that others may read meanwhile.

    Args:
        path: the file.
        mode: "r", "r+" or "w".

    Raises:
        OSError: it cannot be read or written, with its path.
    """
    try:
        if path.exists() and not path.is_file():  # nobody may ever write into a pipe
            raise OSError(errno.EIO, "it is no regular file")
        with h5py.File(path, mode, locking=False) as file:
            yield file
    except (OSError, RuntimeError) as error:  # h5py raises both
        code = getattr(error, "errno", None) or errno.EIO
        text = getattr(error, "strerror", None) or str(error)
        raise OSError(code, text, str(path)) from error
