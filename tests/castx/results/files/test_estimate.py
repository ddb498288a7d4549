"""The file with estimated errors."""

import pytest

from castx.errors import CaseError
from castx.results.files.estimate import Coarser, Estimate, read_estimate, write_estimate
from castx.results.files.folder import clear_results

pytestmark = pytest.mark.serial

MESH = Coarser(folder="estimate_mesh", ratio=1.5, ended="finished", values={"gap": 1e-4})
STEPS = Coarser(folder="estimate_steps", ratio=2.0, ended="finished", values={"time": 50.0})
FOUND = Estimate(reached=60.0, values={"gap": 1.2e-4, "time": 48.0}, mesh=MESH, steps=STEPS)


def test_what_is_written_is_read(tmp_path):
    assert read_estimate(tmp_path) is None
    write_estimate(tmp_path, FOUND)
    assert read_estimate(tmp_path) == FOUND
    clear_results(tmp_path)
    assert read_estimate(tmp_path) is None


def test_an_error_of_first_order_is_found():
    exact, slope = 3.0, -0.7
    values = {size: exact + slope * size for size in (0.1, 0.18)}
    coarser = Coarser(folder="c", ratio=1.8, ended="finished", values={"n": values[0.18]})
    assert values[0.1] + coarser.change("n", values[0.1]) == pytest.approx(exact, rel=1e-12)


def test_changes_are_known_where_a_run_has_the_number():
    assert FOUND.changes("gap") == (pytest.approx(4e-5), None)
    assert FOUND.changes("time") == (None, -2.0)
    assert FOUND.model_copy(update={"mesh": None}).changes("gap") == (None, None)


@pytest.mark.parametrize("text", ["", "[]", '{"reached": "late"}', '{"reached": NaN}'])
def test_a_broken_file_is_refused(tmp_path, text):
    (tmp_path / "estimate.json").write_text(text)
    with pytest.raises(CaseError, match=r"estimate.json cannot be read"):
        read_estimate(tmp_path)
