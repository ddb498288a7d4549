"""An output folder that cannot be used is refused on all ranks before anything in it is touched."""

import json
from pathlib import Path

import pytest

from castx.errors import CaseError
from castx.results.folder import claim_folder, clear_results


def prepare(comm, action):
    if comm.rank == 0:
        action()
    comm.Barrier()


def test_a_new_folder_is_made(comm, shared_tmp_path):
    claim_folder(shared_tmp_path / "a" / "b", comm)
    comm.Barrier()
    assert (shared_tmp_path / "a" / "b").is_dir()


def test_a_file_in_the_way_is_refused(comm, shared_tmp_path):
    prepare(comm, lambda: (shared_tmp_path / "file").write_text("x"))
    with pytest.raises(CaseError, match="is a file; choose another one with"):
        claim_folder(shared_tmp_path / "file", comm)
    with pytest.raises(CaseError, match="cannot be written: Not a directory"):
        claim_folder(shared_tmp_path / "file" / "below", comm)


def test_a_place_without_permission_is_refused(comm):
    with pytest.raises(CaseError, match="cannot be written"):
        claim_folder(Path("/proc/castx-results"), comm)


def test_a_folder_of_somebody_else_is_refused(comm, shared_tmp_path):
    prepare(comm, lambda: (shared_tmp_path / "thesis.tex").write_text("x"))
    with pytest.raises(CaseError, match=r"files that are not results of castx \(no run.json\)"):
        claim_folder(shared_tmp_path, comm)


@pytest.mark.parametrize("record", ["", "[]", "null", "{}", '"castx"', "7"])
@pytest.mark.serial
def test_a_run_json_of_something_else_does_not_count(comm, tmp_path, record):
    (tmp_path / "run.json").write_text(record)
    with pytest.raises(CaseError, match="not results of castx"):
        claim_folder(tmp_path, comm)


@pytest.mark.serial
def test_old_results_go_and_other_files_stay(comm, tmp_path):
    (tmp_path / "run.json").write_text(json.dumps({"castx": "0.1"}))
    (tmp_path / "fields").mkdir()
    for name in ("probes.csv", "report.html", "fields/castx.pvd", "fields/a_00000_0.vtu"):
        (tmp_path / name).write_text("x")
    (tmp_path / "notes.txt").write_text("x")
    claim_folder(tmp_path, comm)
    assert (tmp_path / "probes.csv").exists()
    clear_results(tmp_path)
    left = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file())
    assert left == ["notes.txt", "run.json"]
