"""The folder of the page: nothing outside of it is read or written."""

import os
import subprocess
import sys

import pytest

from castx.app.workplace import Workplace, claimed, digest_of
from castx.errors import CaseError

pytestmark = pytest.mark.serial


@pytest.fixture
def place(tmp_path):
    """A folder with a case, beside a file that is nobody's business."""
    (tmp_path / "secret.toml").write_text("secret = true")
    folder = tmp_path / "work"
    (folder / "sub").mkdir(parents=True)
    (folder / "sub" / "case.toml").write_text("name = 'a case'\n")
    return Workplace(folder)


@pytest.mark.parametrize(
    "name",
    ["", "../secret.toml", "sub/../../secret.toml", "/etc/passwd", "sub//case.toml", "./x.toml",
     "a\0.toml", ".hidden.toml", "sub/.git/config.toml"],
)  # fmt: skip
def test_names_that_lead_elsewhere_are_refused(place, name):
    with pytest.raises(CaseError):
        place.path(name)
    with pytest.raises(CaseError):
        place.read_case(name)


def test_links_are_refused_whatever_they_lead_to(place):
    (place.folder / "link.toml").symlink_to("../secret.toml")
    (place.folder / "inside.toml").symlink_to("sub/case.toml")
    (place.folder / "away").symlink_to("..")
    for name in ("link.toml", "inside.toml", "away/secret.toml", "away/work/sub/case.toml"):
        with pytest.raises(CaseError, match="link"):
            place.read_case(name)
        with pytest.raises(CaseError, match="link"):
            place.write_case(name, "", "")
    assert place.files()["cases"] == ["sub/case.toml"]
    assert (place.folder.parent / "secret.toml").read_text() == "secret = true"


def test_a_path_outside_has_no_name(place):
    assert place.name_of(place.folder / "results" / "x") == "results/x"
    with pytest.raises(CaseError, match="outside"):
        place.name_of(place.folder / ".." / "other")


def test_pipes_and_large_files_are_no_case_files(place, monkeypatch):
    os.mkfifo(place.folder / "pipe.toml")
    with pytest.raises(CaseError, match="no file"):
        place.read_case("pipe.toml")
    monkeypatch.setattr("castx.app.workplace.LARGEST_CASE", 5)
    with pytest.raises(CaseError, match="too large"):
        place.read_case("sub/case.toml")
    with pytest.raises(CaseError, match="at most"):
        place.write_case("new.toml", "a = 123", "")


def test_a_file_that_has_changed_on_the_disk_is_not_written_over(place):
    text, digest = place.read_case("sub/case.toml")
    second = place.write_case("sub/case.toml", text + "x = 1\n", digest)
    assert second == digest_of(b"name = 'a case'\nx = 1\n")
    with pytest.raises(CaseError, match="has changed"):
        place.write_case("sub/case.toml", "mine", digest)
    with pytest.raises(CaseError, match="has changed"):
        place.write_case("sub/case.toml", "a new one?", "")
    assert (place.folder / "sub" / "case.toml").read_text() == "name = 'a case'\nx = 1\n"


def test_files_are_listed_by_kind(place):
    (place.folder / "part.STEP").write_text("")
    run = place.folder / "results" / "run"
    (run / "fields").mkdir(parents=True)
    (run / "run.json").write_text("{}")
    (run / "fields" / "no.toml").write_text("")
    found = place.files()
    assert found == {
        "cases": ["sub/case.toml"], "parts": ["part.STEP"], "results": ["results/run"]
    }  # fmt: skip


def test_a_second_page_of_a_folder_is_refused(tmp_path):
    code = (
        "import sys; from pathlib import Path; from castx.app.workplace import claimed\n"
        "with claimed(Path(sys.argv[1])): print('claimed')"
    )

    def other():
        return subprocess.run(
            [sys.executable, "-c", code, str(tmp_path)], capture_output=True, text=True, check=False
        )

    with claimed(tmp_path):
        assert "is open on" in other().stderr
    assert other().stdout == "claimed\n"
