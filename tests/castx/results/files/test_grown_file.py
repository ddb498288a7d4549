"""Data sets that grow: blocks stand where the counted steps say, whatever lies behind them."""

from __future__ import annotations

import errno
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from castx.results.files.grown_file import (
    absent_block,
    append_block,
    grown,
    need_room,
    opened,
    set_step,
    step_numbers,
)

pytestmark = pytest.mark.serial


@pytest.fixture
def made(tmp_path):
    """Return the data of a field of two rows and the places of its blocks."""
    with h5py.File(tmp_path / "a.hdf", "w") as file:
        yield grown(file, "T", 2, np.zeros((2, 3))), step_numbers(file, "places", 0)


def block(value):
    return np.full((2, 3), float(value))


def test_blocks_follow_each_other(made):
    data, places = made
    for step in range(300):
        append_block(data, places, step, block(step), 2)
    assert places[:].tolist() == list(range(0, 600, 2))
    assert data.chunks == (2, 3) and data.compression == "gzip"
    np.testing.assert_array_equal(data[:, 0], np.repeat(np.arange(300.0), 2))


def test_steps_without_a_field_share_one_block_without_numbers(made):
    data, places = made
    for step, values in enumerate([None, None, block(1), None, block(2)]):
        append_block(data, places, step, values, 2)
    assert places[:].tolist() == [0, 0, 2, 0, 4]
    assert np.isnan(data[:2]).all() and (data[2:4] == 1).all() and (data[4:] == 2).all()
    assert absent_block(data, places[:]) == 0


def test_what_lies_behind_the_counted_steps_is_written_over(made):
    data, places = made
    for step, values in enumerate([block(0), None, block(2), block(3)]):
        append_block(data, places, step, values, 2)
    append_block(data, places, 1, block(7), 2)  # only the first step has been counted
    append_block(data, places, 2, None, 2)
    assert places[:3].tolist() == [0, 2, 4]
    assert (data[2:4] == 7).all() and np.isnan(data[4:6]).all()
    assert absent_block(data, places[:2]) is None and absent_block(data, places[:3]) == 4


def test_numbers_of_steps_may_have_parts(tmp_path):
    with h5py.File(tmp_path / "a.hdf", "w") as file:
        numbers = step_numbers(file, "cells", [0])
        set_step(numbers, 2, [5])
        assert numbers[:].tolist() == [[0], [0], [5]]


def test_a_full_disk_is_refused_before_it_is_written_to(tmp_path, monkeypatch):
    need_room(tmp_path, 1)
    full = SimpleNamespace(free=999)
    monkeypatch.setattr("castx.results.files.grown_file.shutil.disk_usage", lambda folder: full)
    need_room(tmp_path, 999)
    with pytest.raises(OSError, match="No space left") as refusal:
        need_room(tmp_path, 1000)
    assert refusal.value.errno == errno.ENOSPC and refusal.value.filename == str(tmp_path)


def test_failures_name_the_file(tmp_path):
    (tmp_path / "a.hdf").write_text("no HDF5")
    with pytest.raises(OSError, match="signature") as refusal, opened(tmp_path / "a.hdf", "r+"):
        pass
    assert refusal.value.filename == str(tmp_path / "a.hdf")
    with pytest.raises(FileNotFoundError), opened(tmp_path / "none.hdf", "r"):
        pass
