"""Every demo runs and gives the number it is about."""

import os
import re
import subprocess
import sys
from pathlib import Path

import jupytext
import nbclient
import pytest

from castx.case import load_case
from castx.results import read_series

DEMOS = Path(__file__).parents[1] / "demos"
pytestmark = pytest.mark.serial


@pytest.mark.parametrize("name", [path.name for path in sorted(DEMOS.glob("*.toml"))])
def test_case_files_are_valid(name):
    case = load_case(DEMOS / name)
    assert case.output.folder.name == Path(name).stem
    assert case.name and case.probes


def test_the_driver_runs_on_two_ranks(tmp_path):
    foreign = ("PMIX", "PRTE", "PMI_", "OMPI_COMM", "OMPI_UNIVERSE")
    environment = {key: value for key, value in os.environ.items() if not key.startswith(foreign)}
    run = subprocess.run(
        ["mpirun", "-n", "2", sys.executable, str(DEMOS / "cylinder.py")],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert run.returncode == 0, run.stderr
    found = re.search(r"solid after ([\d.]+) s", run.stdout)
    assert found is not None and 50.0 < float(found[1]) < 66.0
    history = read_series(tmp_path / "results" / "cylinder_driver" / "history.csv")
    assert history["casting/mould.mean_gap"][-1] == pytest.approx(1e-4, rel=0.1)


def test_the_notebook_shows_that_the_gap_delays_solidification():
    notebook = jupytext.read(DEMOS / "cylinder_notebook.py")
    client = nbclient.NotebookClient(
        notebook, timeout=500, kernel_name="python3", resources={"metadata": {"path": str(DEMOS)}}
    )
    client.execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    text = "".join(output.get("text", "") for output in outputs)
    found = re.search(r"delay: ([\d.]+)", text)
    assert found is not None and 1.3 < float(found[1]) < 1.55
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 2
