"""Rows of the summary beside the findings."""

import numpy as np
import pytest

from castx.report.summary.rows import further_rows, numeric_rows, steps_text
from castx.results.files.run_tables import Columns
from tests.castx.report.summary.fake_run import TIME, run

pytestmark = pytest.mark.serial

COUNTS = {
    "steps": 9, "cutbacks": 1, "heat_iterations": 20, "mechanics_iterations": 30, "passes": 11,
}  # fmt: skip


def test_steps_taken_again_are_told():
    assert steps_text(COUNTS) == "9, 1 of them cut"
    assert steps_text({**COUNTS, "repeats": 2}) == "9, 1 of them cut, 2 taken again"


def test_errors_and_effort_are_told():
    history = {"time": TIME, "energy_error": -1e-9 * TIME, "a.force_error": np.full(4, 2e-8)}
    found = run(history=Columns(history))
    found.record |= {
        "totals": COUNTS, "peak_memory": {"all_ranks": 2**20}, "wall": 61.0, "ranks": 2,
        "time_reached": 3.0, "end": 4.0,
    }  # fmt: skip
    rows = dict(numeric_rows(found))
    assert rows["energy error"] == "3.0e-09" and rows["force error"] == "2.0e-08"
    assert rows["iterations"] == "20 heat, 30 mechanics, in 11 passes"
    assert rows["wall clock time"] == "0:01:01 on 2 ranks"
    assert rows["peak memory"] == "1 MiB, all ranks"
    assert dict(further_rows(found)) == {"simulated": "3 of 4 s"}
    found.doubts.append("its last lines are lost")
    assert further_rows(found)[1] == ("in doubt", "its last lines are lost")
