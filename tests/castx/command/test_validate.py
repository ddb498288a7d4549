"""Experiments on the command line: list, refusal with all that is missing, overlay."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from castx.command.cli import Exit, execute
from tests.castx.proof.validation.synthetic import write_experiment
from tests.castx.proof.validation.test_band import unknown

ROOT = Path(__file__).parents[3] / "validation"


@pytest.mark.serial
def test_the_list_says_how_much_is_missing(comm, capsys):
    assert execute(["validate", "--folder", str(ROOT)], comm) == Exit.DONE
    said = capsys.readouterr().out
    names = ("ac4ch_tube", "dumbbell", "sand_ring", "cylindrical_mould")
    assert all(name in said for name in names)


@pytest.mark.serial
def test_a_bar_without_dimensions_and_ranges_is_refused_with_the_list(comm, tmp_path, capsys):
    bare = tmp_path / "all" / "dumbbell"
    shutil.copytree(ROOT / "dumbbell", bare)
    facts = bare / "experiment.toml"
    facts.write_text(facts.read_text().split("[[ranges]]")[0])
    given = ["--folder", str(tmp_path / "all"), "--output", str(tmp_path / "out")]
    code = execute(["validate", "dumbbell", *given], comm)
    assert code == Exit.REFUSED
    said = capsys.readouterr()
    assert "0.9984, model 1" in said.out and "0.3635, no answer" in said.out
    for digit in ("length of the bar", "section of the bar", "stiffness of the green sand"):
        assert digit in said.err
    assert "case.toml: geometry.length" in said.err
    assert not (tmp_path / "out").exists()


@pytest.mark.serial
def test_an_unknown_experiment_is_refused(comm, capsys):
    assert execute(["validate", "dumbell", "--folder", str(ROOT)], comm) == Exit.REFUSED
    assert "dumbbell" in capsys.readouterr().err


def test_a_known_experiment_is_overlaid(comm, shared_tmp_path, capsys):
    if comm.rank == 0:
        write_experiment(shared_tmp_path / "all" / "lumped")
    comm.Barrier()
    output = shared_tmp_path / "results"
    code = execute(
        ["validate", "lumped", "--folder", str(shared_tmp_path / "all"), "--output", str(output)],
        comm,
    )
    assert code == Exit.DONE
    assert (output / "lumped" / "validation.html").is_file()
    if comm.rank == 0:
        said = capsys.readouterr().out
        assert "middle.temperature: RMS" in said and "uncertainty ± 2.5 K, within it" in said


@pytest.mark.serial
def test_an_experiment_with_ranges_is_run_over_them(comm, tmp_path, capsys):
    unknown(tmp_path / "all" / "lumped")
    given = ["--folder", str(tmp_path / "all"), "--output", str(tmp_path), "--processes", "2"]
    assert execute(["validate", "lumped", *given], comm) == Exit.DONE
    said = " ".join(capsys.readouterr().out.split())
    assert "4 of 4 runs have finished" in said and "measured 605 ± 5 K: in the band" in said
    assert (tmp_path / "lumped" / "band.html").is_file()
