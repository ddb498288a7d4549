"""What is written for people: once, and plainly under mpirun."""

import errno
import io

import pytest

from castx.command.terminal import EnduringConsole, console_of
from castx.errors import StorageError


@pytest.mark.ranks
def test_only_the_first_rank_writes(comm, capsys):
    console_of(comm).print("hello")
    assert capsys.readouterr().out == ("hello\n" if comm.rank == 0 else "")


@pytest.mark.serial
def test_nothing_is_a_terminal_under_mpirun(comm, monkeypatch):
    monkeypatch.setenv("PMIX_RANK", "0")
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert not console_of(comm).is_terminal
    monkeypatch.delenv("PMIX_RANK")
    assert console_of(comm).is_terminal


@pytest.mark.ranks
def test_what_a_terminal_would_obey_is_written_out(comm, capsys):
    console_of(comm).print("a\x1b[31mb\u202ec\nd", markup=False)
    assert capsys.readouterr().out == ("a\\x1b[31mb\\u202ec\nd\n" if comm.rank == 0 else "")


class Full(io.StringIO):
    """A stream whose disk is full."""

    def write(self, text):
        raise OSError(errno.ENOSPC, "No space left on device")


class Left(io.StringIO):
    """A stream whose reader has gone."""

    def write(self, text):
        raise BrokenPipeError(errno.EPIPE, "Broken pipe")


@pytest.mark.serial
def test_a_full_disk_is_told_only_by_what_was_asked_for_its_text():
    console = EnduringConsole(file=Full())
    console.print("lost")
    console.print("lost")
    with pytest.raises(StorageError, match="the output cannot be written: No space left"):
        console.refuse_loss()


@pytest.mark.serial
def test_a_reader_that_leaves_is_nobodys_fault():
    console = EnduringConsole(file=Left())
    console.print("lost")
    console.refuse_loss()
    assert console.quiet
