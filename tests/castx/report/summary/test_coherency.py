"""What a report says about coherency."""

import pytest

from castx.report.summary.coherency import coherency
from castx.results.files.sensitivity import Sensitivity, VariedRun, write_sensitivity
from tests.castx.report.summary.fake_run import run

pytestmark = pytest.mark.serial

MOULD = "casting/mould"


def fake(folder, **changes):
    record = run().record | {
        "case": {"file": "/a/part.toml"},
        "time_reached": 60.0,
        "bodies": {
            "casting": {"coherency": {"value": 0.9, "source": "representative value"}},
            "mould": {"coherency": None},
        },
    }
    return run(folder=folder, record=record, **changes)


def varied(coherency, frozen, gap):
    return VariedRun(
        folder=".", coherency={"casting": coherency}, ended="finished", reached=60.0,
        frozen={"casting": frozen}, gaps={MOULD: gap},
    )  # fmt: skip


def test_a_run_alone_says_number_source_and_command(tmp_path):
    (found,) = coherency(fake(tmp_path))
    assert (found.name, found.number) == ("Coherency: casting", "0.9")
    assert "; representative value. " in found.sentence
    assert found.sentence.endswith("castx run /a/part.toml --sensitivity coherency")


def test_runs_beside_it_say_what_hangs_on_it(tmp_path):
    runs = varied(0.85, 55.0, 9e-5), varied(0.9, 40.0, 5e-5), varied(0.95, 30.0, 6e-5)
    write_sensitivity(tmp_path, Sensitivity(of="coherency", runs=runs))
    number, time, gap = coherency(fake(tmp_path))
    assert number.value == 0.9 and "castx run" not in number.sentence
    assert (time.name, time.number) == ("Freezing time by coherency: casting", "25 s")
    assert time.sentence.endswith("coherency of 0.85: 55 s; of 0.9: 40 s; of 0.95: 30 s.")
    assert (gap.name, gap.number) == (f"Largest gap by coherency: {MOULD}", "40 µm")
    assert gap.sentence.endswith("of 0.85: 90 µm; of 0.9: 50 µm; of 0.95: 60 µm.")


def test_runs_beside_a_run_that_went_on_do_not_count(tmp_path):
    runs = varied(0.85, 55.0, 9e-5), varied(0.9, 40.0, 5e-5)
    write_sensitivity(tmp_path, Sensitivity(of="coherency", runs=runs))
    later = fake(tmp_path)
    later.record["time_reached"] = 90.0
    (number,) = coherency(later)
    assert "castx run" in number.sentence


def test_what_is_not_frozen_bounds_the_time(tmp_path):
    runs = varied(0.85, None, 9e-5), varied(0.9, 40.0, 5e-5)
    write_sensitivity(tmp_path, Sensitivity(of="coherency", runs=runs))
    time = next(f for f in coherency(fake(tmp_path)) if f.unit == "s")
    assert time.value == 20.0 and time.sentence.startswith("At least: ")
    assert "of 0.85: not frozen at the end, 60 s" in time.sentence


def test_nothing_frozen_has_no_time(tmp_path):
    runs = varied(0.85, None, 9e-5), varied(0.9, None, 5e-5)
    write_sensitivity(tmp_path, Sensitivity(of="coherency", runs=runs))
    assert not [found for found in coherency(fake(tmp_path)) if found.unit == "s"]


def test_a_metal_without_mush_has_no_finding(tmp_path):
    assert list(coherency(run(folder=tmp_path))) == []
