"""The small case on disk, and what commands have printed about it."""

from __future__ import annotations

from functools import partial

import pytest

from tests.castx import command_line


@pytest.fixture
def case_file(comm, shared_tmp_path):
    """Return the path of the small coupled case."""
    path = shared_tmp_path / "case.toml"
    if comm.rank == 0:
        path.write_text(command_line.CASE)
    comm.Barrier()
    return path


@pytest.fixture
def said(comm, capsys):
    """Return what tells what rank 0 has printed since it was asked last."""
    return partial(command_line.said, comm, capsys)
