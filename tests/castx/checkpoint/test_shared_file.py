"""A file that all ranks write takes the place of another when it is whole, and only then."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest

from castx.checkpoint.file import Checkpoint
from castx.checkpoint.shared_file import SharedFile
from tests.castx.checkpoint.test_chunks import dealt
from tests.castx.command_line import start


def names(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


def write(comm, path, text: str, verify=lambda path: None) -> None:
    """Let the ranks write a text of one letter for each, side by side."""
    with SharedFile(path, comm) as file:

        def put(opened):
            opened.seek(comm.rank)
            opened.write(text[comm.rank].encode())

        file.write(put)
        file.replace(verify)


@pytest.mark.ranks
def test_ranks_write_side_by_side_and_replace_the_old_file(comm, shared_tmp_path):
    path = shared_tmp_path / "made" / "file"
    for text in ("abc", "xyz"):
        write(comm, path, text)
        assert path.read_text() == text[: comm.size]
        comm.Barrier()
    assert names(path.parent) == ["file"]


def refuse(path: Path) -> None:
    raise ValueError("a hole")


@pytest.mark.ranks
def test_what_does_not_read_back_leaves_the_old_file(comm, shared_tmp_path):
    path = shared_tmp_path / "file"
    write(comm, path, "old")
    with pytest.raises(OSError, match="what was written does not read back: a hole"):
        write(comm, path, "new", verify=refuse)
    comm.Barrier()
    assert path.read_text() == "old"[: comm.size] and names(shared_tmp_path) == ["file"]


@pytest.mark.ranks
def test_a_failure_of_one_rank_is_that_of_all(comm, shared_tmp_path):
    path = shared_tmp_path / "file"
    write(comm, path, "old")

    def fail(_):
        raise OSError(122, os.strerror(122))

    with pytest.raises(OSError, match="Disk quota exceeded"), SharedFile(path, comm) as file:
        if comm.rank == comm.size - 1:
            file.write(fail)
        file.replace(lambda path: None)
    comm.Barrier()
    assert path.read_text() == "old"[: comm.size] and names(shared_tmp_path) == ["file"]


@pytest.mark.ranks
def test_a_bug_leaves_the_old_file(comm, shared_tmp_path):
    path = shared_tmp_path / "file"
    write(comm, path, "old")
    with pytest.raises(ZeroDivisionError), SharedFile(path, comm):
        raise ZeroDivisionError
    comm.Barrier()
    assert path.read_text() == "old"[: comm.size] and names(shared_tmp_path) == ["file"]


KILLED = """
import os, signal, sys
from pathlib import Path
from mpi4py import MPI
import castx.checkpoint.shared_file as shared_file
from castx.checkpoint import chunks
from castx.checkpoint.file import Checkpoint
from tests.castx.checkpoint.test_chunks import dealt

chunks.ROWS = 16
comm = MPI.COMM_WORLD
checkpoint = Checkpoint(Path.cwd(), comm)
checkpoint.write(dealt(comm, 100), {"which": "old"})
whole = getattr(shared_file, sys.argv[1])

def kill(*arguments):
    if comm.rank == int(sys.argv[2]):
        os.kill(os.getpid(), signal.SIGKILL)
    return whole(*arguments)

setattr(shared_file, sys.argv[1], kill)
checkpoint.write(dealt(comm, 100), {"which": "new"})
"""


@pytest.mark.serial
@pytest.mark.parametrize(
    ("place", "rank", "which"), [("_to_disk", 1, "old"), ("_sync_folder", 0, "new")]
)
def test_a_rank_killed_while_it_writes_leaves_a_whole_checkpoint(
    comm, tmp_path, monkeypatch, place, rank, which
):
    """And what it leaves besides is removed by the next one."""
    (tmp_path / "write.py").write_text(KILLED)
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[3]))
    monkeypatch.chdir(tmp_path)
    process = start("mpirun", "-n", "2", sys.executable, "write.py", place, str(rank))
    _, errors = process.communicate(timeout=120)
    assert process.returncode != 0 and "Traceback" not in errors
    checkpoint = Checkpoint(tmp_path, comm)
    header = checkpoint.read_header()
    assert header is not None and header["which"] == which
    names = [path.name for path in (tmp_path / "checkpoint").iterdir()]
    assert len(names) == (2 if which == "old" else 1)
    state = dealt(comm, 100)
    checkpoint.write(state, {"which": "next"})
    assert [path.name for path in (tmp_path / "checkpoint").iterdir()] == ["state.npz"]
    found = checkpoint.read({"arrays": list(state)}, state)
    assert all(np.array_equal(found[name], saved.values) for name, saved in state.items())
