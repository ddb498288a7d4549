"""How far a run is, from its folder while it grows."""

import json
import math
import shutil

import pytest

from castx.app.runs.progress import RunProgress, version_of
from castx.results.files.reason import Reason

pytestmark = pytest.mark.serial

COLUMNS = "time,step,heat_iterations,mechanics_iterations,passes,casting.solid_fraction"


def write_run(folder, steps):
    """Write a run whose casting gains a quarter of its solid in each second."""
    folder.mkdir(exist_ok=True)
    record = {
        "castx": "0.1.0", "model": "3d", "case": {"name": "a run"},
        "exit": {"reason": Reason.RUNNING, "message": ""},
        "bodies": {"casting": {"material": "Al-pure", "freezes": [660.0, 660.0]}},
    }  # fmt: skip
    (folder / "run.json").write_text(json.dumps(record))
    rows = [f"{step},1,2,2,1,{step / 4}" for step in range(steps + 1)]
    (folder / "history.csv").write_text("\n".join([COLUMNS, *rows]) + "\n")
    (folder / "probes.csv").write_text("time\n" + "".join(f"{s}\n" for s in range(steps + 1)))
    return folder


def test_a_folder_without_results_has_none(tmp_path):
    assert RunProgress().state(tmp_path / "none", 0) == {"version": 0}
    (tmp_path / "run.json").write_text("{}")
    (tmp_path / "history.csv").write_text("time\n")
    found = RunProgress().state(tmp_path, 0)
    assert found["curves"] == [] and "castx" in found["said"]


def test_curves_come_when_they_are_new(tmp_path):
    folder = write_run(tmp_path / "run", steps=3)
    progress = RunProgress()
    first = progress.state(folder, 0)
    assert first["time"] == 3.0 and first["steps"] == 3 and first["solid"] == {"casting": 0.75}
    (solid,) = [p for s in first["curves"] for p in s["panels"] if p["label"] == "solid [%]"]
    assert solid["tables"][0]["lines"][0]["values"] == [0.0, 25.0, 50.0, 75.0]
    again = progress.state(folder, first["version"])
    assert again["version"] == first["version"] and "curves" not in again
    write_run(folder, steps=4)
    later = progress.state(folder, first["version"])
    assert later["version"] != first["version"] and later["time"] == 4.0 and later["curves"]
    assert first["left"] is None, "the steps have no wall clock times"
    shutil.rmtree(folder)
    assert version_of(folder) == 0


def write_clocked(folder, sizes, solids, end, largest=None):
    """Write a run of steps of 2 s on the wall clock, which goes on."""
    write_run(folder, steps=0)
    record = json.loads((folder / "run.json").read_text()) | {"end": end}
    (folder / "run.json").write_text(json.dumps(record))
    if largest is not None:
        case = {"time": {"end": end, "largest_step": largest}}
        (folder / "case.json").write_text(json.dumps(case))
    columns = "time,step,wall,heat_iterations,mechanics_iterations,passes,casting.solid_fraction"
    rows, time = [columns, "0,0,0,0,0,0,0"], 0.0
    for size, solid in zip(sizes, solids, strict=True):
        time += size
        rows.append(f"{time},{size},2,2,1,1,{solid}")
    (folder / "history.csv").write_text("\n".join(rows) + "\n")
    (folder / "probes.csv").write_text(
        "time\n" + "".join(f"{row.split(',')[0]}\n" for row in rows[1:])
    )
    return folder


def test_the_time_left_is_unknown_until_the_casting_freezes(tmp_path):
    folder = write_clocked(tmp_path / "run", [0.1] * 3, [0.0, 0.001, 0.002], end=1.0)
    assert RunProgress().state(folder, 0)["left"] is None
    folder = write_clocked(tmp_path / "run", [0.1] * 4, [0.0, 0.1, 0.2, 0.3], end=1.0)
    found = RunProgress().state(folder, 0)
    assert found["left"] == pytest.approx(6 * 2.0) and found["exit"] == ""


def test_steps_are_bounded_by_the_case_in_the_folder(tmp_path):
    sizes, solids = [1.0, 1.5, 2.25], [1.0] * 3
    without = write_clocked(tmp_path / "without", sizes, solids, end=100.0)
    bounded = write_clocked(tmp_path / "bounded", sizes, solids, end=100.0, largest="3 s")
    rest = 100.0 - sum(sizes)
    assert RunProgress().state(bounded, 0)["left"] == pytest.approx(2.0 * math.ceil(rest / 3.0))
    assert RunProgress().state(without, 0)["left"] < 30.0


def test_a_run_that_has_ended_has_no_time_left(tmp_path):
    folder = write_clocked(tmp_path / "run", [1.0, 1.0], [1.0, 1.0], end=10.0)
    record = json.loads((folder / "run.json").read_text()) | {"exit": {"reason": "failed"}}
    (folder / "run.json").write_text(json.dumps(record))
    assert RunProgress().state(folder, 0)["left"] is None
