"""The driver of the demos runs on two ranks and ends with the casting solid."""

import re
import runpy
from pathlib import Path

import pytest

from castx.results.files.series import read_series

DRIVER = Path(__file__).parents[2] / "demos" / "cylinder.py"


@pytest.mark.slow
@pytest.mark.ranks
def test_the_driver_runs_on_two_ranks(comm, shared_tmp_path, monkeypatch, capsys):
    if comm.size != 2:
        pytest.skip("three ranks, or two beside other tests, wait for processors most of the time")
    monkeypatch.chdir(shared_tmp_path)
    runpy.run_path(str(DRIVER))
    found = re.search(r"solid after ([\d.]+) s", comm.bcast(capsys.readouterr().out))
    assert found is not None and 60.0 < float(found[1]) < 68.0
    comm.Barrier()
    history = read_series(shared_tmp_path / "results" / "cylinder_driver" / "history.csv")
    assert history["casting/mould.mean_gap"][-1] == pytest.approx(1.1e-4, rel=0.05)
