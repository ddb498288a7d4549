"""Record and tables of a results folder: what is there, and refusals with what is."""

import json

import pytest

from castx.errors import CaseError
from castx.results.files.run_tables import Columns, RunTables, is_newer
from castx.version import __version__

pytestmark = pytest.mark.serial


@pytest.fixture
def tables(tmp_path):
    record = {
        "castx": "0",
        "model": "3d",
        "bodies": {"casting": {}},
        "interfaces": {},
        "hot_spots": [{"body": "casting", "pool": 2, "deficit": 1e-8}],
        "stage_ends": [{"stage": 0, "time": 5.0}, {"stage": 2, "time": 9.0}],
    }
    (tmp_path / "run.json").write_text(json.dumps(record))
    (tmp_path / "history.csv").write_text("time,step\n0,0\n1,1\n")
    (tmp_path / "probes.csv").write_text("time\n0\n1\n")
    return RunTables(tmp_path)


def test_hot_spots_and_ends_of_stages_are_those_of_the_record(tables):
    assert [spot["pool"] for spot in tables.hot_spots] == [2]
    assert [end["time"] for end in tables.stage_ends] == [5.0, 9.0]
    assert tables.stage_end(2)["time"] == 9.0
    with pytest.raises(CaseError, match="no stage 1 has ended; stages that have: 0, 2"):
        tables.stage_end(1)
    assert tables.bodies == ("casting",) and tables.interfaces == ()


def test_columns_of_the_history_have_units(tables):
    assert tables.history_unit("step") == "s"
    with pytest.raises(CaseError, match="there are: time, step"):
        tables.history_unit("energy")


def test_columns_name_what_exists(tables):
    assert tables.history["step"].tolist() == [0.0, 1.0]
    with pytest.raises(CaseError, match="there are: time, step"):
        tables.history["energy"]
    assert Columns().get("none") is None


def test_other_folders_are_refused(tmp_path):
    with pytest.raises(CaseError, match="is not a results folder of castx"):
        RunTables(tmp_path)


def test_what_is_not_as_the_run_has_left_it_is_in_doubt(tables):
    assert tables.doubts == []
    tables.record |= {"castx": "99.1"}
    assert "was written by castx 99.1, this is" in tables.doubts[0]
    tables.record |= {"castx": "0", "time_reached": 4.0}
    doubts = tables.doubts
    assert len(doubts) == 2
    for name, doubt in zip(("history.csv", "probes.csv"), doubts, strict=True):
        assert f"{name} ends at t = 1 s, but the run reached 4 s: its last lines are lost" in doubt
    tables.history["time"][-1] = 4.0
    assert tables.doubts == doubts[1:]


@pytest.mark.parametrize(
    ("version", "newer"),
    [(__version__, False), ("0.1.9", False), ("", False), ("x", False), ("1000", True)],
)
def test_versions_are_compared_by_their_numbers(version, newer):
    assert is_newer(version) is newer
