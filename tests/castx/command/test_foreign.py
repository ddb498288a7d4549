"""The cases of other programs on the command line: list, verdicts, page and exit code."""

from __future__ import annotations

from dataclasses import replace

import pytest

from castx.command.cli import Exit, execute
from castx.errors import ConvergenceError
from castx.proof.foreign import registry
from castx.proof.foreign.registry import FOREIGN_CASES


@pytest.mark.ranks
def test_a_case_is_run_and_shown(comm, shared_tmp_path, capsys):
    folder = shared_tmp_path / "page"
    assert execute(["verify", "--foreign", "X1", "--output", str(folder)], comm) == Exit.DONE
    if comm.rank == 0:
        said = capsys.readouterr().out
        assert "X1" in said and "1 cases of other programs, all met" in said
        assert FOREIGN_CASES["X1"].title in (folder / "foreign.html").read_text()


@pytest.mark.serial
def test_what_is_missed_or_fails_ends_with_its_exit_code(comm, tmp_path, capsys, monkeypatch):
    def off(comm):
        return tuple(replace(number, computed=0.0) for number in FOREIGN_CASES["X1"].run(comm))

    def fail(comm):
        raise ConvergenceError("no solution with the smallest step")

    cases = {
        name: replace(FOREIGN_CASES["X1"], number=name, run=run)
        for name, run in (("X1", off), ("X2", fail))
    }
    monkeypatch.setattr(registry, "FOREIGN_CASES", cases)
    assert execute(["verify", "--foreign", "--output", str(tmp_path)], comm) == Exit.FAILED
    said = capsys.readouterr().out
    assert "missed: X1, X2" in said and "MISSED: no solution with the smallest step" in said


@pytest.mark.serial
def test_the_list_names_all_and_runs_none(comm, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert execute(["verify", "--foreign", "--list"], comm) == Exit.DONE
    said = capsys.readouterr().out
    assert all(number in said for number in FOREIGN_CASES)
    assert not list(tmp_path.iterdir())


@pytest.mark.serial
def test_an_unknown_number_is_refused(comm, capsys):
    assert execute(["verify", "--foreign", "V1"], comm) == Exit.REFUSED
    assert "no foreign case 'V1'" in capsys.readouterr().err
