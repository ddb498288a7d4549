"""Runs from their case file to their results folder, and all the ways in which they end."""

from __future__ import annotations

import json
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import load_case
from castx.command.cli import execute
from castx.command.run import RunSettings, restart_command, run, run_case, with_output
from castx.errors import CaseError
from castx.profiling import RunPart
from castx.results.reading import Results
from tests.castx.command_line import start, wait_for


def test_the_folder_is_that_of_the_case_or_the_given_one(comm, case_file, shared_tmp_path):
    short = ["time.end=0.05"]
    folder = shared_tmp_path / "given"
    assert run(case_file, [*short, f'output.folder="{folder}"'], comm=comm) == folder
    other = shared_tmp_path / "other"
    assert run(case_file, short, output=other, comm=comm) == other
    one, two = (Results(found).history["casting.enthalpy"] for found in (folder, other))
    np.testing.assert_array_equal(one, two)


@pytest.mark.serial
def test_the_command_that_goes_on_has_all_options():
    options = {
        "case_file": Path("my case.toml"), "output": None, "time_limit": "8 h", "sensitivity": None,
        "estimate": True, "profile": False, "overrides": ["time.end=4", "name='x y'"], "adapt": 0,
    }  # fmt: skip
    said = restart_command(options)
    assert shlex.split(said) == [
        "castx", "run", "my case.toml", "--time-limit", "8 h", "--estimate", "--set", "time.end=4",
        "--set", "name='x y'", "--restart",
    ]  # fmt: skip
    more = {"output": Path("out"), "sensitivity": "coherency", "overrides": None, "adapt": 2}
    said = restart_command({**options, **more})
    assert "--output out --time-limit '8 h' --sensitivity coherency --adapt 2 --estimate" in said


def test_a_relative_folder_is_that_of_the_present_one(case_file, monkeypatch):
    monkeypatch.chdir(case_file.parent)
    case = with_output(load_case(case_file), Path("out"))
    assert case.output.folder == case_file.parent / "out"
    assert case.digest == load_case(case_file).digest


@pytest.mark.ranks
def test_a_time_limit_interrupts_and_a_restart_goes_on(comm, case_file, shared_tmp_path):
    folder = shared_tmp_path / "out"
    with pytest.raises(KeyboardInterrupt, match="time limit of 1e-06 s"):
        run(case_file, output=folder, comm=comm, time_limit=1e-6)
    stopped = Results(folder)
    assert stopped.record["exit"]["reason"] == "interrupted"
    assert len(stopped.history["time"]) == 2  # one try is always made
    comm.Barrier()
    run(case_file, output=folder, comm=comm, restart=True)
    finished = Results(folder)
    assert finished.record["exit"]["reason"] == "finished"
    assert finished.history["time"][-1] == pytest.approx(0.2)
    assert len(finished.record["restarts"]) == 1
    assert finished.times == [0.0, stopped.history["time"][-1], finished.history["time"][-1]]
    assert finished.field("temperature", "casting").values.max() < 670.0 + 1e-6


@pytest.mark.ranks
def test_a_second_run_keeps_the_results_of_the_first_one(comm, case_file, shared_tmp_path, said):
    """As a whole, so that they can be read and gone on with, whatever the second one changes."""
    folder, kept = shared_tmp_path / "out", shared_tmp_path / "out.1"
    run(case_file, ["time.end=0.05"], output=folder, comm=comm)
    first = Results(folder).history["casting.enthalpy"]
    comm.Barrier()
    hotter = ["time.end=0.05", "bodies.0.temperature=690"]
    assert execute(["run", str(case_file), "--output", str(folder), *_set(hotter)], comm) == 0
    assert f"the results of the earlier run are kept in {kept}" in said() or comm.rank
    np.testing.assert_array_equal(Results(kept).history["casting.enthalpy"], first)
    assert Results(folder).history["casting.enthalpy"][0] > first[0]
    comm.Barrier()
    run(case_file, ["time.end=0.1"], output=kept, comm=comm, restart=True)
    assert Results(kept).history["time"][-1] == pytest.approx(0.1)
    assert not (shared_tmp_path / "out.2").exists() and not (shared_tmp_path / "out.1.1").exists()


def _set(overrides):
    return [word for override in overrides for word in ("--set", override)]


def test_a_finished_run_has_nothing_to_go_on_with(comm, case_file, shared_tmp_path):
    folder = run(case_file, ["time.end=0.05"], output=shared_tmp_path / "out", comm=comm)
    before = (folder / "history.csv").read_bytes()
    comm.Barrier()
    case = with_output(load_case(case_file, ["time.end=0.05"]), folder)
    assert run_case(case, RunSettings(comm, restart=True)) == folder
    assert (folder / "history.csv").read_bytes() == before


def test_a_refused_run_leaves_no_folder(comm, case_file, shared_tmp_path):
    folder = shared_tmp_path / "out"
    probe = 'probes=[{ name = "far", body = "casting", at = [1, 1], quantities = ["temperature"] }]'
    with pytest.raises(CaseError, match="lies outside body 'casting'"):
        run(case_file, [probe], output=folder, comm=comm)
    comm.Barrier()
    assert not folder.exists()


def test_a_run_leaves_its_results_and_says_where(comm, case_file, shared_tmp_path, said):
    folder = shared_tmp_path / "out"
    assert execute(["run", str(case_file), "--output", str(folder)], comm) == 0
    text = said()
    assert "step 1" in text and f"done: {folder}" in text
    assert json.loads((folder / "run.json").read_text())["exit"]["reason"] == "finished"


def test_a_profile_says_what_the_parts_have_cost(comm, case_file, shared_tmp_path, said):
    folder, begin = shared_tmp_path / "out", time.perf_counter()
    assert execute(["run", str(case_file), "--output", str(folder), "--profile"], comm) == 0
    passed = comm.allreduce(time.perf_counter() - begin, max)
    record, text = json.loads((folder / "run.json").read_text()), said()
    costs = record["profile"]
    assert list(costs) == [str(part) for part in RunPart]
    for part in ("start", "heat", "assembly", "contact", "set-up", "solve", "output"):
        assert costs[part]["time"] >= costs[part]["mean_time"] > 0 and part in text
    assert costs["heat"]["flops"] > 0 and costs["solve"]["flops"] > 0
    assert sum(cost["mean_time"] for cost in costs.values()) < passed
    assert ("messages" in text) == (costs["heat"]["messages"] > 0) == (comm.size > 1)


@pytest.mark.ranks
def test_set_replaces_values(comm, case_file, shared_tmp_path, said):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder), "--set", "time.end=0.05"]
    assert execute(arguments, comm) == 0
    assert json.loads((folder / "run.json").read_text())["time_reached"] == 0.05


def test_an_output_that_cannot_be_written_is_refused(comm, case_file, said):
    assert execute(["run", str(case_file), "--output", str(case_file)], comm) == 2
    assert "is a file" in said()


@pytest.mark.ranks
def test_a_run_that_does_not_converge_leaves_its_last_state(comm, case_file, shared_tmp_path, said):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder)]
    for override in ("solver.mechanics.snes_max_it=0", "time.smallest_step=0.05"):
        arguments += ["--set", override]
    assert execute(arguments, comm) == 3
    assert "castx: not converged: no solution with the smallest step" in said()
    assert json.loads((folder / "run.json").read_text())["exit"]["reason"] == "not converged"
    assert Results(folder).times == [0.0]


@pytest.mark.ranks
def test_a_run_names_a_material_that_leaves_its_range_once(comm, case_file, tmp_path, said):
    arguments = ["run", str(case_file), "--set", "bodies.1.temperature=620"]
    folder = comm.bcast(str(tmp_path / "hot"))
    assert execute([*arguments, "--output", folder], comm) == 0
    text = " ".join(said().split())
    assert text.count("said once for each material") == 1
    assert "at t = 0 s steel-H13 (mould) is at 620 to 620 °C" in text


@pytest.mark.sampled
@pytest.mark.serial
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_a_run_after_its_step_with_its_files(case_file, tmp_path, number):
    folder = tmp_path / "out"
    process = start(
        sys.executable, "-m", "castx", "run", str(case_file), "--output", str(folder),
        "--set", "time.end=1e4", "--set", "time.largest_step=0.01",
        "--set", "time.first_step=0.01",
    )  # fmt: skip
    wait_for(lambda: (folder / "history.csv").exists() and steps(folder) > 3, process)
    process.send_signal(number)
    process.send_signal(number)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    goes_on = (
        f"castx run {case_file} --output {folder} --set time.end=1e4 --set time.largest_step=0.01 "
        "--set time.first_step=0.01 --restart"
    )
    assert f"stopped by a signal; go on with {goes_on}" in " ".join(errors.split())
    record = json.loads((folder / "run.json").read_text())
    assert record["exit"] == {"reason": "interrupted", "message": "stopped by a signal"}
    assert record["totals"]["steps"] == steps(folder) - 1
    assert Results(folder).times == [0.0, record["time_reached"]]


@pytest.mark.slow
@pytest.mark.serial
@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_run_goes_on_when_its_reader_leaves(case_file, tmp_path, stream):
    folder = tmp_path / "out"
    process = start(
        sys.executable, "-m", "castx", "run", str(case_file), "--output", str(folder),
        "--set", "time.largest_step=0.02", "--set", "time.first_step=0.01",
    )  # fmt: skip
    getattr(process, stream).close()
    assert process.wait(timeout=60) == 0
    record = json.loads((folder / "run.json").read_text())
    assert record["exit"]["reason"] == "finished" and record["time_reached"] == 0.2
    assert (folder / "checkpoint" / "state.npz").exists()


@pytest.mark.serial
def test_a_run_goes_on_when_its_log_has_no_room(case_file, tmp_path):
    folder = tmp_path / "out"
    command = [sys.executable, "-m", "castx", "run", str(case_file), "--output", str(folder)]
    with open("/dev/full", "w") as full:
        ended = subprocess.run(command, stdout=full, stderr=full, timeout=60, check=False)
    assert ended.returncode == 0
    assert json.loads((folder / "run.json").read_text())["exit"]["reason"] == "finished"


def steps(folder: Path) -> int:
    return len((folder / "history.csv").read_text().splitlines()) - 1
