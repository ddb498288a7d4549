"""Archives give back the same bits, and say what is wrong with a damaged file."""

from __future__ import annotations

import json
import zipfile

import numpy as np
import pytest

from castx.checkpoint.archive import (
    FORMAT,
    HEADER,
    ArchiveWriter,
    fault_of,
    read_array,
    read_header,
)
from castx.errors import CaseError

pytestmark = pytest.mark.serial

ARRAYS = {
    "heat/enthalpy/casting": np.array([1.0 / 3.0, np.nan, -np.inf, 1e-310]),
    "interfaces/casting/mould/closed": np.array([[True, False], [False, True]]),
    "clock/step": np.array(7, dtype=np.int64),
    "empty": np.zeros((0, 6)),
}


def write(path, arrays=ARRAYS, **header):
    with ArchiveWriter(path, header) as archive:
        for name, array in arrays.items():
            archive.add(name, array)
    return path


def test_arrays_and_header_come_back_with_the_same_bits(tmp_path):
    path = write(tmp_path / "state.npz", time=1.5)
    assert fault_of(path) is None
    header = read_header(path)
    assert header["time"] == 1.5 and header["arrays"] == list(ARRAYS)
    for name, array in ARRAYS.items():
        found = read_array(path, name)
        assert (found.dtype, found.shape) == (array.dtype, array.shape)
        assert found.tobytes() == array.tobytes()


def test_numpy_opens_an_archive(tmp_path):
    with np.load(write(tmp_path / "state.npz")) as opened:
        np.testing.assert_array_equal(opened["clock/step"], 7)


def test_an_error_while_writing_leaves_the_old_file_alone(tmp_path):
    path = write(tmp_path / "state.npz", which="old")
    before = path.read_bytes()
    with pytest.raises(ZeroDivisionError), ArchiveWriter(path, {"which": "new"}) as archive:
        archive.add("a", np.ones(3))
        raise ZeroDivisionError
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.iterdir()] == ["state.npz"]


def test_a_new_file_takes_the_place_of_the_old_one(tmp_path):
    path = write(tmp_path / "state.npz", which="old")
    write(path, {"a": np.ones(3)}, which="new")
    assert read_header(path)["which"] == "new" and read_header(path)["arrays"] == ["a"]
    assert [file.name for file in tmp_path.iterdir()] == ["state.npz"]


def flipped(content: bytes, place: int) -> bytes:
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


def test_every_flipped_bit_of_an_array_is_found(tmp_path):
    """The checksum names the array."""
    path = write(tmp_path / "state.npz", {"first": np.arange(9.0), "second": np.arange(9.0)})
    content = path.read_bytes()
    start = content.index(np.arange(9.0).tobytes())
    for place in range(start, start + 72, 17):
        path.write_bytes(flipped(content, place))
        assert fault_of(path) == "the checksum of first.npy is wrong"


@pytest.mark.parametrize("left", [0.0, 0.3, 0.99])
def test_a_file_that_was_cut_short_is_refused(tmp_path, left):
    path = write(tmp_path / "state.npz")
    content = path.read_bytes()
    path.write_bytes(content[: int(left * len(content))])
    with pytest.raises(CaseError, match=r"state\.npz is damaged: .*; put a whole copy"):
        read_header(path)


def with_header(path, header) -> None:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(HEADER, json.dumps(header))


def test_an_archive_that_lacks_an_array_is_refused(tmp_path):
    with_header(tmp_path / "state.npz", {"format": FORMAT, "arrays": ["heat/time"]})
    assert fault_of(tmp_path / "state.npz") == "it lacks heat/time.npy"


def test_another_arrangement_of_files_is_refused(tmp_path):
    with_header(tmp_path / "state.npz", {"format": FORMAT + 1, "arrays": []})
    fault = fault_of(tmp_path / "state.npz")
    assert fault == f"it has format {FORMAT + 1}, this version of castx reads {FORMAT}"
