"""Runs that are interrupted, killed or fail go on, and what cannot go on is left as it was."""

import json
import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

from mpi4py import MPI

import numpy as np
import pytest

from castx.checkpoint.file import Checkpoint
from castx.command.cli import execute
from castx.coupling.step import CoupledProblem
from castx.errors import ConvergenceError
from castx.results.files.series import read_series
from tests.castx.command_line import CASE, said, start, wait_for

OUTPUT = """
[output]
every = 0.2
checkpoint = 0.1
fields = ["temperature", "displacement", "von_mises", "solidification_time"]
[[probes]]
name = "p"
body = "casting"
at = [0, 0.02]
quantities = ["temperature", "displacement", "stress"]
"""


NOTHING = {"displacement": 1e-6, "gap": 1e-6, "stress": 1.0, "pressure": 1.0, "force": 1e-3}
"""SI, by a part of the name of a column."""


@pytest.fixture
def case_file(comm, shared_tmp_path):
    path = shared_tmp_path / "case.toml"
    if comm.rank == 0:
        path.write_text(CASE.replace("end = 0.2", "end = 0.5") + OUTPUT)
    comm.Barrier()
    return path


def content(folder):
    """Return the bytes of all files of a folder but those that come and go with a process."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != ".lock"
    }


def same_series(a, b, tolerance):
    for file in ("probes.csv", "history.csv"):
        one, other = read_series(a / file), read_series(b / file)
        assert list(one) == list(other)
        kept = [key for key in one if key not in ("wall", "energy_error")]
        differences = {key: np.abs(one[key] - other[key]).max() for key in kept}
        allowed = {key: tolerance * max(np.abs(one[key]).max(), nothing(key)) for key in kept}
        assert {k: v for k, v in differences.items() if v > allowed[k]} == {}


def nothing(key):
    """Return what is nothing beside a casting: all that liquid moves or bears is round-off."""
    return next((floor for quantity, floor in NOTHING.items() if quantity in key), 0.0)


def test_a_run_stopped_behind_each_step_ends_like_one_that_was_not(
    comm, case_file, shared_tmp_path, capsys
):
    whole, parts = shared_tmp_path / "whole", shared_tmp_path / "parts"
    assert execute(["run", str(case_file), "--output", str(whole)], comm) == 0
    arguments = ["run", str(case_file), "--output", str(parts), "--time-limit", "1 ms"]
    code, count = execute(arguments, comm), 1
    while code == 130 and count < 50:
        assert "interrupted: the time limit of 0.001 s" in said(comm, capsys)
        code, count = execute([*arguments, "--restart"], comm), count + 1
    assert code == 0 and count > 5
    same_series(whole, parts, 0.0 if comm.size == 1 else 1e-6)
    record = json.loads((parts / "run.json").read_text())
    once = json.loads((whole / "run.json").read_text())
    # Stopped behind each step but the last.
    assert len(record["restarts"]) == count - 1
    assert record["totals"] == once["totals"] and record["exit"]["reason"] == "finished"
    assert once["restarts"] == [] and record["started"] <= record["written"]


def test_a_finished_run_goes_on_when_its_end_is_moved(comm, case_file, shared_tmp_path, capsys):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder), "--restart"]
    assert execute(arguments, comm) == 0
    assert "no checkpoint in" in said(comm, capsys)
    before = content(folder)
    assert execute(arguments, comm) == 0
    assert content(folder) == before
    comm.Barrier()
    assert execute([*arguments, "--set", "time.end=0.7", "--set", "probes=[]"], comm) == 0
    times = read_series(folder / "history.csv")["time"]
    assert times[-1] == pytest.approx(0.7) and (np.diff(times) > 0).all()


def test_a_run_that_did_not_converge_goes_on_when_it_can(
    comm, case_file, shared_tmp_path, capsys, monkeypatch
):
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder), "--restart"]
    advance = CoupledProblem.advance

    def fail(self, time, *given):
        report = advance(self, time, *given)
        if time > 0.2:
            raise ConvergenceError("too few passes")
        return report

    monkeypatch.setattr(CoupledProblem, "advance", fail)
    assert execute([*arguments, "--set", "time.smallest_step=0.05"], comm) == 3
    assert "too few passes" in said(comm, capsys)
    reached = json.loads((folder / "run.json").read_text())["time_reached"]
    monkeypatch.undo()
    comm.Barrier()
    assert execute(arguments, comm) == 0
    times = read_series(folder / "history.csv")["time"]
    assert 0.2 < reached < 0.4 and reached in times and times[-1] == pytest.approx(0.5)


def spoil_case(folder, case_file):
    case_file.write_text(case_file.read_text().replace("temperature = 670", "temperature = 680"))


def spoil_checkpoint(folder, case_file):
    path = folder / "checkpoint" / "state.npz"
    path.write_bytes(path.read_bytes()[:5000])


def lose_checkpoint(folder, case_file):
    (folder / "checkpoint" / "state.npz").unlink()


def take_other_results(folder, case_file):
    case_file.rename(case_file.with_name("other.toml"))
    case_file.with_name("other.toml").write_text(CASE)
    record = json.loads((folder / "run.json").read_text())
    record["case"] |= {"file": "/home/somebody/wheel.toml", "name": "wheel", "digest": "7"}
    (folder / "run.json").write_text(json.dumps(record))


def change_mesh(folder, case_file):
    part = case_file.with_name("part.msh")
    finer = case_file.with_name("finer.msh")
    shutil.move(finer, part)


def lose_mesh(folder, case_file):
    case_file.with_name("part.msh").unlink()


@pytest.mark.sampled
@pytest.mark.parametrize(
    "spoil, text",
    [
        (spoil_case, "bodies[0].temperature = 680 (it was 670)"),
        (spoil_checkpoint, "state.npz is damaged"),
        (lose_checkpoint, "holds results, but no checkpoint to go on from"),
        (take_other_results, "holds results of another case, 'wheel'"),
        (change_mesh, "the mesh is not the one of"),
        (lose_mesh, "there is no mesh file"),
    ],
)
def test_what_cannot_go_on_is_refused_and_nothing_is_touched(
    comm, case_file, shared_tmp_path, capsys, spoil, text
):
    folder = shared_tmp_path / "out"
    for name, size in (("part.msh", "5 mm"), ("finer.msh", "4 mm")):
        change = ["--set", f"geometry.size={size}", "-o", str(shared_tmp_path / name)]
        assert execute(["mesh", str(case_file), *change], comm) == 0
    if comm.rank == 0:
        _, tail = case_file.read_text().split("[[bodies]]", 1)
        geometry = '[geometry]\nmodel = "axisymmetric"\nfile = "part.msh"\n'
        case_file.write_text(geometry + "[[bodies]]" + tail)
    comm.Barrier()
    arguments = ["run", str(case_file), "--output", str(folder)]
    assert execute([*arguments, "--set", "time.end=0.1"], comm) == 0
    if comm.rank == 0:
        spoil(folder, case_file)
    comm.Barrier()
    before = content(folder)
    capsys.readouterr()
    if not case_file.exists():
        arguments[1] = str(case_file.with_name("other.toml"))
    assert execute([*arguments, "--restart"], comm) == 2
    message = said(comm, capsys)
    assert text in message and "Traceback" not in message
    assert content(folder) == before


@pytest.mark.slow
@pytest.mark.serial
def test_runs_killed_at_random_moments_are_not_lost(case_file, tmp_path):
    whole, killed = tmp_path / "whole", tmp_path / "killed"
    command = [sys.executable, "-m", "castx", "run", str(case_file), "--set", "time.end=1.5"]
    command += ["--set", "output.checkpoint=0.05"]
    process = start(*command, "--output", str(whole))
    process.communicate(timeout=120)
    dice = random.Random(6)
    for _ in range(3):
        process = start(*command, "--output", str(killed), "--restart")
        rows = dice.randint(1, 15)
        wait_for(lambda rows=rows: lines(killed) >= rows, process)
        time.sleep(dice.uniform(0.0, 0.1))
        process.kill()
        process.communicate(timeout=60)
    process = start(*command, "--output", str(killed), "--restart")
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    assert (killed / "probes.csv").read_bytes() == (whole / "probes.csv").read_bytes()
    same_series(whole, killed, 0.0)


def lines(folder: Path) -> int:
    path = folder / "history.csv"
    return len(path.read_bytes().splitlines()) - 1 if path.exists() else 0


@pytest.mark.slow
@pytest.mark.serial
def test_a_full_disk_ends_a_run_that_goes_on_when_there_is_room(case_file, tmp_path, comm):
    """Files may not grow beyond a limit, which the history does at last."""
    folder = tmp_path / "out"
    largest = 80_000
    limited = (  # once MPI has its own files, the memory that ranks share
        "from mpi4py import MPI; import resource; from castx.command.cli import main; "
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({largest}, {largest})); main()"
    )
    arguments = ["run", str(case_file), "--output", str(folder),
                 "--set", "time.largest_step=0.002", "--set", "time.first_step=0.002"]  # fmt: skip
    full = subprocess.run(
        [sys.executable, "-c", limited, *arguments], capture_output=True, text=True, timeout=120
    )
    assert full.returncode == 1, full.stderr
    message = " ".join(full.stderr.split())
    assert "File too large" in message and "--restart" in message and "Traceback" not in message
    reached = json.loads((folder / "run.json").read_text())["time_reached"]
    assert 0.0 < reached < 0.5
    assert execute([*arguments, "--restart"], comm) == 0
    times = read_series(folder / "history.csv")["time"]
    assert (np.diff(times) > 0).all() and times[-1] == pytest.approx(0.5)


ALONE = """
import sys, time
from mpi4py import MPI
import castx.command.run
from castx.command.cli import execute
from castx.errors import CaseError
def fail(*arguments):
    if MPI.COMM_WORLD.rank == 1:
        raise CaseError("on one rank")
    MPI.COMM_WORLD.Barrier()
castx.command.run.asked_case = fail
sys.exit(execute(["run", "case.toml"], MPI.COMM_WORLD))
"""


@pytest.mark.slow
@pytest.mark.serial
def test_a_refusal_on_one_rank_ends_all_of_them_soon(tmp_path):
    script = tmp_path / "alone.py"
    script.write_text(ALONE)
    process = start("mpirun", "-n", "2", sys.executable, str(script))
    begin = time.monotonic()
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 2, errors
    assert "rank 1 has failed alone" in errors
    assert time.monotonic() - begin < 30.0


@pytest.mark.serial
def test_checkpoints_come_as_often_as_asked(case_file, tmp_path, comm, monkeypatch):
    written = []
    write = Checkpoint.write

    def count(self, state, header):
        written.append(round(header["time"], 9))
        write(self, state, header)

    monkeypatch.setattr(Checkpoint, "write", count)
    arguments = ["run", str(case_file), "--output", str(tmp_path / "out")]
    assert execute([*arguments, "--set", "output.checkpoint=0.2"], comm) == 0
    times = read_series(tmp_path / "out" / "history.csv")["time"]
    first = [min(t for t in times if t > k - 1e-9) for k in (0.0, 0.2, 0.4)]
    assert written == pytest.approx([*first, 0.5])
    written.clear()
    monkeypatch.setattr("castx.checkpoint.writing.EVERY", 0.0)
    monkeypatch.setattr("castx.checkpoint.writing.LARGEST_SHARE", 1e9)
    assert execute([*arguments, "--set", "output.checkpoint=1e3"], comm) == 0
    assert written == [0.0, 0.5]
    del written[:]
    case_file.write_text(case_file.read_text().replace("checkpoint = 0.1\n", ""))
    assert execute(arguments, comm) == 0
    assert written == [*np.round(times, 9), 0.5]


@pytest.fixture
def halfway(comm, case_file, shared_tmp_path):
    """Return the arguments that go on with a run stopped behind its first steps, and its folder."""
    folder = shared_tmp_path / "out"
    arguments = ["run", str(case_file), "--output", str(folder)]
    assert execute([*arguments, "--set", "time.end=0.2"], comm) == 0
    comm.Barrier()
    return [*arguments, "--restart"], folder


def spoil(comm, path, change):
    comm.Barrier()  # others may still read it
    if comm.rank == 0:
        text = change(path.read_bytes())
        path.unlink()
        if text is not None:
            path.write_bytes(text)
    comm.Barrier()


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda text: b"\n".join(text.split(b"\n")[:2]) + b"\n", "it has 1 lines, and"),
        (lambda text: text + b"\xff", "no table of numbers"),
        (
            lambda text: b"".join(sorted(text.splitlines(keepends=True), reverse=True)),
            "does not come after the one before it in time",
        ),
    ],
)
@pytest.mark.parametrize("name", ["history.csv", "probes.csv"])
def test_a_table_that_is_not_as_it_was_is_refused(
    comm, halfway, case_file, capsys, name, change, message
):
    arguments, folder = halfway
    if comm.rank == 0:
        assert b"time" in (folder / name).read_bytes()
    spoil(comm, folder / name, change)
    before = content(folder)
    assert execute(arguments, comm) == 2
    text = said(comm, capsys)
    assert f"{folder / name} is not as the run has left it: " in text
    assert message in text and "or remove it to go on without" in text
    assert "checkpoint" not in text.replace("before the checkpoint", "")
    assert content(folder) == before


def test_damaged_fields_are_refused_before_anything_is_written(comm, halfway, capsys):
    arguments, folder = halfway
    fields = folder / "fields" / "casting.hdf"
    spoil(comm, fields, lambda text: text[: len(text) // 2])
    before = content(folder)
    assert execute(arguments, comm) == 1
    text = said(comm, capsys)
    assert f"cannot write {fields}: it is damaged (" in text
    assert "move it away, and the restart begins a new one" in text
    assert content(folder) == before
    spoil(comm, fields, lambda _: None)
    assert execute(arguments, comm) == 0


def test_a_table_that_was_removed_goes_on_behind_its_loss(comm, halfway, capsys):
    arguments, folder = halfway
    rows = len(read_series(folder / "history.csv")["time"])
    spoil(comm, folder / "history.csv", lambda _: None)
    assert execute([*arguments, "--set", "time.end=0.3"], comm) == 0
    assert "is missing: what it held up to t = 0.2 s is lost" in said(comm, capsys)
    times = [read_series(folder / name)["time"] for name in ("history.csv", "probes.csv")]
    assert times[0].tolist() == times[1][rows:].tolist() and times[0][0] > 0.2
    comm.Barrier()
    assert execute(arguments, comm) == 0
    assert "is missing" not in said(comm, capsys)
    times = [read_series(folder / name)["time"] for name in ("history.csv", "probes.csv")]
    assert times[0].tolist() == times[1][rows:].tolist() and times[0][-1] == 0.5


@pytest.mark.ranks
def test_a_record_with_wrong_types_is_refused(comm, halfway, capsys):
    arguments, folder = halfway
    right, wrong = b'"time_reached": 0.2', b'"time_reached": []'
    spoil(comm, folder / "run.json", lambda text: text.replace(right, wrong))
    spoil(comm, folder / "checkpoint" / "state.npz", lambda _: None)
    assert execute(arguments, comm) == 2
    assert "not results of castx (run.json is not one of castx)" in said(comm, capsys)
    if comm.rank == 0:
        assert execute(["report", str(folder)], MPI.COMM_SELF) == 2
        assert "time_reached: Input should be a valid number" in capsys.readouterr().err
