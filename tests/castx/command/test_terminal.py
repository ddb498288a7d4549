"""What is written for people: once, and plainly under mpirun."""

import pytest

from castx.command.terminal import console_of


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
