"""A failure of the disk on one rank ends the run on all of them together."""

from __future__ import annotations

import pytest

from castx.errors import StorageError
from castx.results.files.disk import Disk, description_of


@pytest.mark.ranks
@pytest.mark.parametrize("rank", [0, -1])
def test_a_failure_on_one_rank_is_raised_on_all(comm, rank):
    disk = Disk(comm)
    with disk.writing():
        if comm.rank == rank % comm.size:
            raise OSError(28, "No space left on device", "/results/history.csv")
    with pytest.raises(StorageError, match=r"cannot write /results/history\.csv: No space left"):
        disk.raise_failures()
    disk.raise_failures()  # it is raised once


@pytest.mark.ranks
def test_the_first_failure_of_a_rank_counts(comm):
    disk = Disk(comm)
    for reason in ("first", "second"):
        with disk.writing():
            raise OSError(5, reason, "file")
    with pytest.raises(StorageError, match=r"cannot write file: first; .*--restart"):
        disk.raise_failures()


@pytest.mark.ranks
def test_what_is_not_the_disk_passes_through(comm):
    disk = Disk(comm)
    with pytest.raises(ZeroDivisionError), disk.writing():
        raise ZeroDivisionError
    disk.raise_failures()


@pytest.mark.serial
@pytest.mark.parametrize(
    "error, text",
    [
        (OSError(13, "Permission denied", "a.vtu"), "cannot write a.vtu: Permission denied"),
        (OSError("cannot write b.vtu"), "cannot write results: cannot write b.vtu"),
    ],
)
def test_a_failure_names_file_and_reason(error, text):
    assert description_of(error) == text
