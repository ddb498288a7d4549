"""Archives are what numpy reads, and say what is wrong with a damaged file."""

from __future__ import annotations

import json
import zipfile
import zlib

from mpi4py import MPI

import numpy as np
import pytest

from castx.checkpoint import archive
from castx.checkpoint.archive import (
    FORMAT,
    HEADER,
    PAGE,
    arranged,
    read_contents,
    read_verified,
    write_contents,
)
from castx.checkpoint.chunks import ROWS

ARRAYS = {
    "heat/enthalpy/casting": np.array([1.0 / 3.0, np.nan, -np.inf, 1e-310]),
    "interfaces/Gießling/mould/closed": np.array([[True, False], [False, True]]),
    "clock/step": np.array(7, dtype=np.int64),
    "empty": np.zeros((0, 6)),
}


def write(path, arrays=ARRAYS, **header):
    entries = arranged((name, array.dtype, array.shape) for name, array in arrays.items())
    with path.open("wb") as file:
        for entry in entries:
            file.seek(entry.data)
            file.write(arrays[entry.name].tobytes())
        checksums = [zlib.crc32(array.tobytes()) for array in arrays.values()]
        write_contents(file, entries, checksums, header)
    return path


def fault_of(path, comm=MPI.COMM_SELF) -> str:
    try:
        read_verified(path, comm)
    except ValueError as fault:
        return str(fault)
    return ""


@pytest.mark.serial
def test_numpy_opens_an_archive_and_finds_the_same_bits(tmp_path):
    path = write(tmp_path / "state.npz", time=1.5)
    assert zipfile.ZipFile(path).testzip() is None
    with np.load(path) as opened:
        for name, array in ARRAYS.items():
            assert (opened[name].dtype, opened[name].shape) == (array.dtype, array.shape)
            assert opened[name].tobytes() == array.tobytes()


@pytest.mark.serial
def test_contents_come_back(tmp_path):
    path = write(tmp_path / "state.npz", time=1.5)
    header, entries, _ = read_verified(path, MPI.COMM_SELF)
    assert header["time"] == 1.5 and header["arrays"] == list(ARRAYS)
    for name, array in ARRAYS.items():
        content = path.read_bytes()[entries[name].data : entries[name].end]
        assert content == array.tobytes()
        assert (entries[name].dtype, entries[name].shape) == (array.dtype, array.shape)


@pytest.mark.serial
def test_pages_that_several_ranks_write_are_not_shared(tmp_path):
    """Chunks are whole pages, and their arrays have pages of their own."""
    large = np.zeros(2 * ROWS + 3, dtype=bool)
    arrays = {"a": np.arange(3.0), "b": large, "c": np.arange(3.0), "d": large[:ROWS]}
    entries = read_contents(write(tmp_path / "state.npz", arrays)).entries
    assert entries["b"].data % PAGE == 0 and ROWS * large.itemsize % PAGE == 0
    assert entries["a"].end < entries["b"].data and entries["b"].end <= 4 * PAGE
    assert 4 * PAGE < entries["c"].data < entries["d"].data < 4 * PAGE + 1000


@pytest.mark.serial
def test_a_file_of_zipfile_and_numpy_is_one(tmp_path):
    """So earlier versions wrote theirs."""
    with zipfile.ZipFile(tmp_path / "state.npz", "w") as file:
        for name, array in ARRAYS.items():
            with file.open(f"{name}.npy", "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)
        file.writestr(HEADER, json.dumps({"format": FORMAT, "arrays": list(ARRAYS)}))
    entries = read_verified(tmp_path / "state.npz", MPI.COMM_SELF).entries
    for name, array in ARRAYS.items():
        place = slice(entries[name].data, entries[name].end)
        assert (tmp_path / "state.npz").read_bytes()[place] == array.tobytes()


def flipped(content: bytes, place: int) -> bytes:
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


@pytest.mark.ranks
@pytest.mark.parametrize("part", [archive.PART, 1000])
def test_every_flipped_bit_of_an_array_is_found(comm, shared_tmp_path, monkeypatch, part):
    """The checksum names the array, whichever rank has read the place."""
    monkeypatch.setattr(archive, "PART", part)
    path = shared_tmp_path / "state.npz"
    if comm.rank == 0:
        write(path, {"first": np.arange(2e3), "second": np.arange(2e3)})
    comm.Barrier()
    assert fault_of(path, comm) == ""
    content = path.read_bytes()
    start = content.index(np.arange(2e3).tobytes())
    for place in range(start + 5000, start + 16_000, 2700):  # zipfile verifies what is shorter
        comm.Barrier()
        if comm.rank == 0:
            path.write_bytes(flipped(content, place))
        comm.Barrier()
        assert fault_of(path, comm) == "the checksum of first.npy is wrong"


@pytest.mark.serial
def test_no_flipped_byte_changes_what_is_read(tmp_path):
    """Nor leads to another error than a refusal."""
    path = write(tmp_path / "state.npz", {"first": np.arange(3.0), "second": np.arange(2)})
    content, whole = path.read_bytes(), read_verified(path, MPI.COMM_SELF)
    refused = 0
    for place in range(len(content)):
        path.write_bytes(content[:place] + bytes([content[place] ^ 0xFF]) + content[place + 1 :])
        try:
            found = read_verified(path, MPI.COMM_SELF)
        except ValueError:
            refused += 1
        else:
            assert found == whole
    assert refused > len(content) // 2


@pytest.mark.ranks
@pytest.mark.parametrize("left", [0.0, 0.3, 0.99])
def test_a_file_that_was_cut_short_is_refused(comm, shared_tmp_path, left):
    path = shared_tmp_path / "state.npz"
    if comm.rank == 0:
        content = write(path).read_bytes()
        path.write_bytes(content[: int(left * len(content))])
    comm.Barrier()
    assert fault_of(path, comm) != ""


def with_header(path, header, **arrays) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr(HEADER, json.dumps(header))
        for name, array in arrays.items():
            with file.open(f"{name}.npy", "w") as member:
                np.lib.format.write_array(member, array)


@pytest.mark.serial
def test_an_archive_that_lacks_an_array_is_refused(tmp_path):
    with_header(tmp_path / "state.npz", {"format": FORMAT, "arrays": ["heat/time"]})
    assert fault_of(tmp_path / "state.npz") == "it lacks heat/time.npy"


@pytest.mark.serial
def test_another_arrangement_of_files_is_refused(tmp_path):
    with_header(tmp_path / "state.npz", {"format": FORMAT + 1, "arrays": []})
    fault = fault_of(tmp_path / "state.npz")
    assert fault == f"it has format {FORMAT + 1}, this version of castx reads {FORMAT}"


@pytest.mark.serial
@pytest.mark.parametrize("arrays", [None, -1, [None], {"a": 1}])
def test_a_header_without_a_list_of_arrays_is_refused(comm, tmp_path, arrays):
    with_header(tmp_path / "state.npz", {"format": FORMAT, "arrays": arrays})
    with pytest.raises(ValueError):
        read_verified(tmp_path / "state.npz", comm)


@pytest.mark.serial
def test_compressed_arrays_are_refused(tmp_path):
    with_header(tmp_path / "state.npz", {"format": FORMAT, "arrays": ["a"]}, a=np.zeros(9))
    assert fault_of(tmp_path / "state.npz") == "a.npy is not stored as castx does"
