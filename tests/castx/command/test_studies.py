"""The commands of many runs, on runs of castx in processes of their own."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from castx.command.cli import execute
from castx.command.run import run
from castx.results.files.run_tables import RunTables
from tests.castx.many_runs import CASE

TABLE = """
[vary]
method = "grid"
processes = 2
[[vary.inputs]]
of = "interfaces.0.heat.closed"
name = "h"
low = "1000 W/m^2/K"
high = "4000 W/m^2/K"
points = 2
"""


@pytest.mark.serial
def test_a_run_of_a_study_is_that_of_castx_run(comm, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + TABLE)
    short = ["--set", "time.end=2"]
    assert execute(["vary", "case.toml", *short], comm) == 0
    assert "2 runs, 2 of them made now" in capsys.readouterr().out
    folder = tmp_path / "results/case.vary"
    rows = list(csv.DictReader((folder / "table.csv").open()))
    assert [row["h [W/m^2/K]"] for row in rows] == ["1000", "4000"]
    assert [row["ended"] for row in rows] == ["finished"] * 2
    own = RunTables(run("case.toml", ["time.end=2", "interfaces.0.heat.closed=4000"], comm=comm,
                        output="own"))  # fmt: skip
    found = RunTables(folder / rows[1]["folder"] / "results")
    np.testing.assert_array_equal(found.probes["near.temperature"], own.probes["near.temperature"])
    before = (folder / "table.csv").read_text()
    assert execute(["vary", "case.toml", *short], comm) == 0
    assert "2 runs, 0 of them made now" in capsys.readouterr().out
    assert (folder / "table.csv").read_text() == before


@pytest.mark.serial
def test_a_wrong_study_is_refused(comm, tmp_path, capsys):
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + TABLE.replace('"grid"', '"gird"'))
    for command in ("vary", "check"):
        assert execute([command, str(case_file)], comm) == 2
        words = " ".join(capsys.readouterr().err.split())
        assert 'vary.method = "gird": unknown; allowed: grid, latin-hypercube' in words
    assert not (tmp_path / "results").exists()


@pytest.mark.ranks
def test_ranks_are_refused(comm, case_file, said):
    code = execute(["vary", str(case_file)], comm)
    assert code == 2
    wanted = "leave mpirun out" if comm.size > 1 else "has no table [vary]"
    assert wanted in said()
