"""An output folder that cannot be used is refused on all ranks before anything in it is touched."""

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from castx.case.reading.read import read_case
from castx.errors import CaseError, StorageError
from castx.results.files.folder import (
    LOCK,
    FolderLock,
    claimed_folder,
    clear_results,
    keep_results,
    own_identity,
    store_text,
)
from tests.castx.case_data import cylinder


def claimed(comm, folder, **changes):
    case = read_case(cylinder(output__folder=str(folder), **changes), Path("case.toml"))
    return claimed_folder(case, comm)


def prepare(comm, action):
    if comm.rank == 0:
        action()
    comm.Barrier()


def test_a_new_folder_is_made(comm, shared_tmp_path):
    with claimed(comm, shared_tmp_path / "a" / "b"):
        comm.Barrier()
        assert (shared_tmp_path / "a" / "b").is_dir()
        comm.Barrier()
    comm.Barrier()
    assert not (shared_tmp_path / "a" / "b").exists()


def test_a_file_in_the_way_is_refused(comm, shared_tmp_path):
    prepare(comm, lambda: (shared_tmp_path / "file").write_text("x"))
    with pytest.raises(CaseError, match="is a file; choose another one with"):
        claimed(comm, shared_tmp_path / "file").__enter__()
    with pytest.raises(CaseError, match="cannot be written: Not a directory"):
        claimed(comm, shared_tmp_path / "file" / "below").__enter__()


@pytest.mark.ranks
def test_a_place_without_permission_is_refused(comm):
    with pytest.raises(CaseError, match="cannot be written"):
        claimed(comm, Path("/proc/castx-results")).__enter__()


def test_a_folder_of_somebody_else_is_refused(comm, shared_tmp_path):
    prepare(comm, lambda: (shared_tmp_path / "thesis.tex").write_text("x"))
    with pytest.raises(CaseError, match=r"files that are not results of castx \(no run.json\)"):
        claimed(comm, shared_tmp_path).__enter__()


@pytest.mark.parametrize("record", ["", "[]", "null", "{}", '"castx"', "7"])
@pytest.mark.serial
def test_a_run_json_of_something_else_does_not_count(comm, tmp_path, record):
    (tmp_path / "run.json").write_text(record)
    with pytest.raises(CaseError, match="not results of castx"):
        claimed(comm, tmp_path).__enter__()


def test_results_of_another_case_are_refused_and_those_of_the_same_file_not(comm, shared_tmp_path):
    def record(file):
        case = {"name": "the other", "file": str(Path(file).resolve()), "digest": "0"}
        (shared_tmp_path / "run.json").write_text(json.dumps({"castx": "0.1", "case": case}))

    prepare(comm, lambda: record("other.toml"))
    with pytest.raises(CaseError, match=r"results of another case, 'the other' \(.*other.toml\)"):
        claimed(comm, shared_tmp_path).__enter__()
    prepare(comm, lambda: record("case.toml"))
    with claimed(comm, shared_tmp_path):
        pass
    comm.Barrier()
    assert (shared_tmp_path / "run.json").exists()


def test_a_folder_in_use_is_refused_until_it_is_free(comm, shared_tmp_path):
    with claimed(comm, shared_tmp_path):
        refusal = rf"in use by process {comm.bcast(os.getpid())} on .*delete .*{LOCK}"
        with pytest.raises(CaseError, match=refusal):
            claimed(comm, shared_tmp_path).__enter__()
    with claimed(comm, shared_tmp_path):
        pass


HOLDER = """
import sys, time
from pathlib import Path
from castx.results.files.folder import FolderLock
lock = FolderLock(Path(sys.argv[1]))
assert lock.acquire() is None
print("held", flush=True)
time.sleep(60)
"""


@pytest.mark.serial
def test_what_a_killed_run_leaves_does_not_stand_in_the_way(comm, tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None and process.stdout.readline() == "held\n"
    with pytest.raises(CaseError, match=f"in use by process {process.pid} on"):
        claimed(comm, tmp_path).__enter__()
    process.kill()
    process.wait()
    process.stdout.close()
    assert (tmp_path / LOCK).exists()
    with claimed(comm, tmp_path):
        pass
    assert not (tmp_path / LOCK).exists()


@pytest.mark.serial
@pytest.mark.parametrize(
    "change, held",
    [
        ({"process": 2**22 + 1}, False),
        ({"process": os.getppid()}, True),
        ({"host": "elsewhere"}, True),
        ({"namespace": "pid:[1]"}, True),
    ],
)
def test_process_and_host_decide_where_files_cannot_be_locked(tmp_path, monkeypatch, change, held):
    def unsupported(*_):
        raise OSError(38, "Function not implemented")

    monkeypatch.setattr("castx.results.files.folder.fcntl.flock", unsupported)
    (tmp_path / LOCK).write_text(json.dumps(own_identity() | change))
    assert (FolderLock(tmp_path).acquire() is not None) is held


@pytest.mark.serial
def test_old_results_go_and_other_files_stay(comm, tmp_path):
    (tmp_path / "run.json").write_text(json.dumps({"castx": "0.1"}))
    (tmp_path / "fields").mkdir()
    (tmp_path / "checkpoint").mkdir()
    for name in ("probes.csv", "report.html", "fields/castx.pvd", "fields/a_00000_0.vtu"):
        (tmp_path / name).write_text("x")
    (tmp_path / "checkpoint" / "state.npz").write_text("x")
    (tmp_path / "notes.txt").write_text("x")
    with claimed(comm, tmp_path):
        assert (tmp_path / "probes.csv").exists()
        clear_results(tmp_path)
    left = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file())
    assert left == ["notes.txt", "run.json"]
    assert not (tmp_path / "checkpoint").exists()


def finished(folder: Path, text: str) -> None:
    """Write what a run leaves in a folder."""
    for name in ("run.json", "history.csv", "report.html", "fields/a.vtu", "checkpoint/state.npz"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text)
    (folder / "run.json").write_text(json.dumps({"castx": "0.1", "said": text}))


@pytest.mark.serial
@pytest.mark.parametrize("linked", [False, True])
def test_results_are_kept_beside_the_folder_under_the_next_number(tmp_path, linked):
    folder = real = tmp_path / "disk" / "out"
    real.mkdir(parents=True)
    if linked:
        folder = tmp_path / "link"
        folder.symlink_to(real)
    (real / "notes.txt").write_text("x")
    (real / LOCK).write_text("x")
    assert keep_results(folder) is None
    for number, text in enumerate(("first", "second"), 1):
        finished(folder, text)
        assert keep_results(folder) == real.with_name(f"out.{number}")
        assert sorted(path.name for path in folder.iterdir()) == [LOCK, "notes.txt"]
    for number, text in enumerate(("first", "second"), 1):
        kept = real.with_name(f"out.{number}")
        assert json.loads((kept / "run.json").read_text())["said"] == text
        assert (kept / "fields" / "a.vtu").read_text() == text
        assert (kept / "checkpoint" / "state.npz").read_text() == text
    (real / "run.json").write_text(json.dumps({"castx": "0.1"}))
    assert keep_results(folder) is None, "a record alone is no result"


@pytest.mark.serial
def test_results_are_kept_inside_where_nothing_can_be_made_beside(tmp_path, monkeypatch):
    finished(tmp_path, "mine")
    whole = Path.mkdir

    def mkdir(self, *arguments, **options):
        if self.parent == tmp_path.parent:
            raise PermissionError(13, "Permission denied")
        whole(self, *arguments, **options)

    monkeypatch.setattr(Path, "mkdir", mkdir)
    assert keep_results(tmp_path) == tmp_path / "earlier.1"
    assert (tmp_path / "earlier.1" / "history.csv").read_text() == "mine"
    assert not (tmp_path / "history.csv").exists()


@pytest.mark.parametrize("name", [LOCK, "fields", "checkpoint", "run.json", "history.csv"])
def test_a_link_in_the_folder_is_refused_and_what_it_leads_to_stays(comm, shared_tmp_path, name):
    folder, mine = shared_tmp_path / "out", shared_tmp_path / "mine"

    def make():
        folder.mkdir()
        (folder / "run.json").write_text(json.dumps({"castx": "0.1"}))
        mine.mkdir()
        (mine / "thesis.vtu").write_text("years of work")
        (folder / name).unlink(missing_ok=True)
        target = mine if name in ("fields", "checkpoint") else mine / "thesis.vtu"
        (folder / name).symlink_to(target)

    prepare(comm, make)
    with pytest.raises(CaseError, match=f"holds a symbolic link, {name}: "):
        claimed(comm, folder).__enter__()
    assert (mine / "thesis.vtu").read_text() == "years of work"


@pytest.mark.serial
def test_a_lock_follows_no_link_and_waits_for_no_pipe(tmp_path):
    (tmp_path / "mine").write_text("years of work")
    (tmp_path / LOCK).symlink_to(tmp_path / "mine")
    with pytest.raises(OSError, match="symbolic links"):
        FolderLock(tmp_path).acquire()
    assert (tmp_path / "mine").read_text() == "years of work"
    (tmp_path / LOCK).unlink()
    os.mkfifo(tmp_path / LOCK)
    with pytest.raises(OSError, match="is no file"):
        FolderLock(tmp_path).acquire()


@pytest.mark.serial
def test_a_second_run_waits_until_the_first_has_said_who_it_is(tmp_path, monkeypatch):
    """The first one has the lock a moment before its name stands in the file."""
    lock = FolderLock(tmp_path)
    assert lock.acquire() is None
    (tmp_path / LOCK).write_text("")
    late = threading.Timer(
        0.2, lambda: (tmp_path / LOCK).write_text(json.dumps(own_identity() | {"process": 77}))
    )
    late.start()
    assert str(FolderLock(tmp_path).acquire()).startswith("process 77 on")
    late.join()
    (tmp_path / LOCK).write_text("")
    monkeypatch.setattr("castx.results.files.folder.PATIENCE", 0.1)
    assert FolderLock(tmp_path).acquire() == "another run that has just begun"
    lock.release()


@pytest.mark.ranks
def test_a_name_that_no_disk_takes_is_refused(comm):
    with pytest.raises(CaseError, match="cannot be written: File name too long; choose another"):
        claimed(comm, Path("/tmp") / ("a" * 300)).__enter__()


@pytest.mark.serial
@pytest.mark.parametrize("name", ["report.html", "nowhere/report.html"])
def test_a_text_that_cannot_be_stored_names_file_reason_and_cure(tmp_path, name):
    store_text(tmp_path / "page.html", "x")
    assert (tmp_path / "page.html").read_text() == "x"
    (tmp_path / "report.html").mkdir()
    with pytest.raises(StorageError, match=f"cannot write .*{name}: .*make room or give permi"):
        store_text(tmp_path / name, "x")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["page.html", "report.html"]
