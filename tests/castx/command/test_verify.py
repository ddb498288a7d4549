"""The verifications on the command line: list, verdicts, page and exit code."""

from __future__ import annotations

import logging
from dataclasses import replace

import pytest

from castx.command.cli import Exit, execute
from castx.proof.verification import registry
from castx.proof.verification.registry import VERIFICATIONS


@pytest.mark.ranks
def test_a_verification_is_run_and_shown(comm, shared_tmp_path, capsys):
    code = execute(["verify", "V9", "--quick", "--output", str(shared_tmp_path / "page")], comm)
    assert code == Exit.DONE
    if comm.rank == 0:
        said = capsys.readouterr().out
        assert "V9" in said and "met" in said and "1 verifications, all met" in said
        text = (shared_tmp_path / "page" / "verification.html").read_text()
        assert VERIFICATIONS["V9"].title in text and "quick" in text
        assert f"{comm.size} rank" in text


@pytest.mark.ranks
def test_messages_are_as_before_behind_the_verifications(comm, shared_tmp_path):
    """Each logger that a verification silences speaks again in the same process."""
    names = ("castx.process.building", "castx.domain")
    before = [logging.getLogger(name).level for name in names]
    execute(["verify", "V9", "--quick", "--output", str(shared_tmp_path / "page")], comm)
    assert [logging.getLogger(name).level for name in names] == before


@pytest.mark.serial
def test_a_tolerance_that_is_missed_fails(comm, tmp_path, monkeypatch, capsys):
    wrong = replace(VERIFICATIONS["V9"], levels=VERIFICATIONS["V9"].quick)

    def too_small(level, comm):
        outcome = VERIFICATIONS["V9"].run(level, comm)
        return replace(outcome, answers=tuple(replace(a, tolerance=1e-30) for a in outcome.answers))

    monkeypatch.setattr(registry, "VERIFICATIONS", {"V9": replace(wrong, run=too_small)})
    assert execute(["verify", "--output", str(tmp_path)], comm) == Exit.FAILED
    assert "missed: V9" in capsys.readouterr().out


@pytest.mark.serial
def test_the_list_names_all_and_runs_none(comm, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert execute(["verify", "--list"], comm) == Exit.DONE
    said = capsys.readouterr().out
    assert all(number in said for number in VERIFICATIONS)
    assert not list(tmp_path.iterdir())


@pytest.mark.serial
def test_an_unknown_number_is_refused(comm, capsys):
    assert execute(["verify", "V77"], comm) == Exit.REFUSED
    assert "no verification 'V77'" in capsys.readouterr().err
