"""The table of a study."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest

from castx.studies.runs.answers import RunAnswer
from castx.studies.runs.kept import KeptRun
from castx.studies.table import StudyTable

pytestmark = pytest.mark.serial


def kept(number, ended="finished"):
    return KeptRun(
        digest="",
        changes={},
        ended=ended,
        said="",
        seconds=1.0,
        processor_seconds=1.0,
        folder=f"runs/{number}",
    )


def gap(value):
    return RunAnswer("Largest gap: a/b", value, "µm", 1e6)


TABLE = StudyTable(
    ["h", "k"], ["W/m^2/K", ""], np.array([[1e3, 1.0], [2e3, 2.0], [3e3, 3.0]]),
    [kept(0), kept(1, "not converged"), kept(2)],
    [{"gap": gap(1e-5), "same": gap(2e-5)}, {}, {"gap": gap(3e-5), "same": gap(2e-5)}],
)  # fmt: skip


def test_answers_are_shown_in_their_unit():
    np.testing.assert_allclose(TABLE.result("gap"), [10.0, np.nan, 30.0])
    assert TABLE.outputs == ["gap", "same"] and TABLE.varied() == ["gap"]


def test_what_tells_of_the_mesh_is_no_answer_that_varies():
    found = [{"gap": replace(gap(value), of_mesh=True)} for value in (1e-5, 3e-5)]
    table = StudyTable(["h"], [""], np.array([[1.0], [2.0]]), [kept(0), kept(1)], found)
    assert table.varied() == [] and "gap" in table.text()


def test_it_is_a_csv_with_a_line_for_each_run():
    rows = list(csv.reader(io.StringIO(TABLE.text())))
    assert rows[0] == ["folder", "ended", "h [W/m^2/K]", "k", "gap [µm]", "same [µm]"]
    assert rows[1] == ["runs/0", "finished", "1000", "1", "10", "20"]
    assert rows[2] == ["runs/1", "not converged", "2000", "2", "", ""]
