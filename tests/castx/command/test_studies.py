"""The commands of many runs, on runs of castx in processes of their own."""

from __future__ import annotations

import csv
import json
import re

import numpy as np
import pytest

from castx.command.cli import execute
from castx.command.run import run
from castx.results.files.run_tables import RunTables
from castx.studies.runs import local
from tests.castx.many_runs import CASE, Formulas

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


IDENTIFY = """
[identify]
[[identify.unknowns]]
name = "h"
of = "interfaces.0.heat.closed"
[[identify.candidates]]
name = "shallow"
body = "mould"
below = "casting/mould"
depth = "1 mm"
at = ["30 mm", "0.5 mm"]
"""
OPTIMISE = """
[optimise]
goal = "Freezes last: casting"
[[optimise.inputs]]
of = "bodies.0.temperature"
name = "pouring"
low = 650
high = 690
"""


@pytest.fixture
def by_formula(monkeypatch):
    """Let studies ask a formula in place of processes."""
    monkeypatch.setattr(local, "LocalProcesses", lambda processes, memory: Formulas(answered))


def answered(content):
    hot = float(content["bodies"][0]["temperature"])
    h = float(str(content["interfaces"][0]["heat"]["closed"]).split()[0])
    time = [float(t) for t in range(7)]
    columns = {"time": time}
    for probe in content["probes"]:
        columns[f"{probe['name']}.temperature"] = [200.0 + h * t / 100.0 for t in time]
    return {"Freezes last: casting": (hot - 660.0) ** 2}, columns


@pytest.mark.serial
def test_a_design_names_places(comm, tmp_path, capsys, by_formula):
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + IDENTIFY)
    arguments = ["identify", str(case_file), "--output", str(tmp_path / "study")]
    assert execute([*arguments, "--design"], comm) == 0
    said = capsys.readouterr().out
    # dT/d ln h is 20 K/s t by differences of 1 %, at 1 to 5 s: 1/√(20.1² 55 + 1/9)
    assert "2 runs, 2 of them made now in " in said and "of processor time" in said
    assert "+ shallow" in said and f"{(20.1**2 * 55 + 1 / 9) ** -0.5:.2g}" in said
    assert execute(arguments, comm) == 2
    assert "nothing was measured" in capsys.readouterr().err


@pytest.mark.serial
def test_an_identified_number_is_shown(comm, tmp_path, capsys, by_formula):
    rows = [f"{t},{200.0 + 15.0 * t + (-1) ** int(2 * t) * 0.1}" for t in np.arange(0.0, 6.1, 0.5)]
    (tmp_path / "near.csv").write_text("\n".join(["time,near.temperature", *rows]) + "\n")
    curve = '[[identify.curves]]\nof = "near.temperature"\nfile = "near.csv"\nnoise = 0.1\n'
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + IDENTIFY + curve)
    assert execute(["identify", str(case_file), "--output", str(tmp_path / "study")], comm) == 0
    said = capsys.readouterr().out
    assert "h: 15" in said or "h: 149" in said
    assert "W/m^2/K (95 %:" in said and (tmp_path / "case.identified.toml").is_file()
    made = re.search(r"(\d+) runs, (\d+) of them made now", said)
    assert made and made[1] == made[2] == str(len(list((tmp_path / "study/runs").iterdir())))


@pytest.mark.serial
def test_a_fit_that_does_not_settle_does_not_tell_of_checkpoints(
    comm, tmp_path, capsys, by_formula
):
    rows = [f"{t},{200.0 + 15.0 * t}" for t in np.arange(0.0, 6.1, 0.5)]
    (tmp_path / "near.csv").write_text("\n".join(["time,near.temperature", *rows]) + "\n")
    curve = '[[identify.curves]]\nof = "near.temperature"\nfile = "near.csv"\nnoise = 0.1\n'
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + IDENTIFY.replace("[identify]", "[identify]\ntries = 1") + curve)
    assert execute(["identify", str(case_file), "--output", str(tmp_path / "study")], comm) == 3
    said = capsys.readouterr().err
    assert "raise tries" in said and "checkpoint" not in said


@pytest.mark.serial
def test_a_check_names_the_studies_that_can_begin(comm, tmp_path, capsys):
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + TABLE)
    assert execute(["check", str(case_file)], comm) == 0
    assert f"[vary] can begin: castx vary {case_file}" in capsys.readouterr().out


@pytest.mark.serial
def test_the_best_numbers_are_shown(comm, tmp_path, capsys, by_formula):
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + OPTIMISE)
    assert execute(["optimise", str(case_file), "--output", str(tmp_path / "study")], comm) == 0
    said = capsys.readouterr().out
    pouring = float(re.search(r"pouring \[°C\]: ([\d.]+)", said)[1])
    assert abs(pouring - 660.0) < 0.5 and "Freezes last: casting [s]:" in said
    assert (tmp_path / "case.optimised.toml").is_file()


SOBOL = """
[vary]
method = "sobol"
draws = 64
[[vary.inputs]]
of = "bodies.0.temperature"
name = "one"
low = 650
high = 690
[[vary.inputs]]
of = "bodies.1.temperature"
name = "two"
low = 200
high = 240
[[vary.inputs]]
of = "materials.die.conductivity"
name = "three"
low = 20
high = 60
"""


@pytest.mark.serial
@pytest.mark.slow
def test_shares_of_a_straight_case(comm, tmp_path, monkeypatch):
    """X1 + 2 X2 + 0.5 X3 of equal widths: 1, 4 and 0.25 parts of 5.25, and nothing together."""

    def straight(content):
        one, two = (float(body["temperature"]) for body in content["bodies"])
        answer = one + 2.0 * two + 0.5 * float(content["materials"]["die"]["conductivity"])
        return {"answer": answer}, {"time": [0.0, 1.0], "near.temperature": [0.0, answer]}

    monkeypatch.setattr(local, "LocalProcesses", lambda processes, memory: Formulas(straight))
    case_file = tmp_path / "case.toml"
    case_file.write_text(CASE + SOBOL)
    folder = tmp_path / "study"
    assert execute(["vary", str(case_file), "--output", str(folder)], comm) == 0
    (answer,) = json.loads((folder / "study.json").read_text())["what matters"]
    found = {effect["name"]: effect["more"] for effect in answer["effects"]}
    exact = {"one": 0.190476, "two": 0.761905, "three": 0.047619}
    for name, share in exact.items():
        assert found[name]["first-order index"] == pytest.approx(share, abs=0.01)
        assert found[name]["total index"] == pytest.approx(share, abs=0.01)
