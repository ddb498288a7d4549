"""The file with the runs beside a run."""

import pytest

from castx.errors import CaseError
from castx.results.files.folder import clear_results
from castx.results.files.sensitivity import (
    Sensitivity,
    VariedRun,
    read_sensitivity,
    write_sensitivity,
)

pytestmark = pytest.mark.serial

MOULD = "casting/mould"
LOW = VariedRun(
    folder="coherency_lower", coherency={"casting": 0.85, "feeder": 0.65}, ended="finished",
    reached=120.0, frozen={"casting": None, "feeder": 80.0}, gaps={MOULD: 1.5e-4},
)  # fmt: skip
HIGH = VariedRun(
    folder=".", coherency={"casting": 0.9, "feeder": 0.7}, ended="not converged",
    reached=12.5, frozen={"casting": None, "feeder": 7.25}, gaps={},
)  # fmt: skip
FOUND = Sensitivity(of="coherency", runs=(LOW, HIGH))


def test_what_is_written_is_read(tmp_path):
    assert read_sensitivity(tmp_path) is None
    write_sensitivity(tmp_path, FOUND)
    assert read_sensitivity(tmp_path) == FOUND


def test_it_goes_with_the_results_of_its_run(tmp_path):
    write_sensitivity(tmp_path, FOUND)
    clear_results(tmp_path)
    assert read_sensitivity(tmp_path) is None


@pytest.mark.parametrize("text", ["{", "[]", '{"of": "coherency", "runs": [{"folder": 3}]}'])
def test_a_broken_file_is_refused(tmp_path, text):
    (tmp_path / "sensitivity.json").write_text(text)
    with pytest.raises(CaseError, match=r"sensitivity.json cannot be read"):
        read_sensitivity(tmp_path)


def test_texts_say_what_was_found():
    assert (FOUND.castings, FOUND.interfaces) == (["casting", "feeder"], [MOULD])
    assert (LOW.number("feeder"), LOW.number()) == ("0.65", "0.85, 0.65")
    assert LOW.freezing_text("feeder") == "80 s"
    assert LOW.freezing_text("casting") == "not frozen at the end, 120 s"
    assert HIGH.freezing_text("casting") == "not frozen when it stopped (not converged), 12.5 s"
    assert (LOW.gap_text(MOULD), HIGH.gap_text(MOULD)) == ("150 µm", "none")
