"""How far a run is, from its folder while it grows."""

import json
import shutil

import pytest

from castx.app.progress import RunProgress, version_of

pytestmark = pytest.mark.serial

COLUMNS = "time,step,heat_iterations,mechanics_iterations,passes,casting.solid_fraction"


def write_run(folder, steps):
    """Write a run whose casting gains a quarter of its solid in each second."""
    folder.mkdir(exist_ok=True)
    record = {
        "castx": "0.1.0", "model": "3d", "case": {"name": "a run"}, "exit": {"reason": ""},
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
    shutil.rmtree(folder)
    assert version_of(folder) == 0
