"""What the page does is done by functions and commands, and only in its folder."""

import pytest

from castx.app.actions import Actions
from castx.app.session import Session
from castx.app.workplace import Workplace
from castx.errors import CaseError
from tests.castx.command_line import CASE

pytestmark = pytest.mark.serial


@pytest.fixture
def actions(tmp_path, monkeypatch):
    folder = tmp_path / "work"
    folder.mkdir()
    monkeypatch.chdir(folder)
    (folder / "case.toml").write_text(CASE)
    return Actions(Workplace(folder), Session())


def test_a_case_by_hand_opens_and_what_is_saved_stands_in_the_file(actions):
    opened = actions.open({"path": "case.toml"})
    assert opened["text"] == CASE and opened["problems"] == []
    text = CASE.replace("end = 0.2", "end = 0")
    saved = actions.save({"path": "case.toml", "text": text, "digest": opened["digest"]})
    assert (actions.workplace.folder / "case.toml").read_text() == text
    assert [p["key"] for p in saved["problems"]] == ["time.end"]
    checked = actions.check({"path": "case.toml", "text": CASE})
    assert checked["problems"] == [] and "digest" not in checked


def test_commands_get_names_below_the_folder_only(actions):
    for path in ("../case.toml", "--help", "missing.toml", "-x.toml"):
        for command in ("check", "run", "report", "rm"):
            with pytest.raises(CaseError):
                actions.command({"command": command, "path": path})
    with pytest.raises(CaseError):
        actions.command({"command": "shell", "path": "case.toml"})
    assert actions.commands.last is None


def test_a_file_that_has_changed_on_the_disk_is_told_and_not_run_unseen(actions):
    known = {"path": "case.toml", "digest": actions.open({"path": "case.toml"})["digest"]}
    assert actions.state(known)["changed"] is False
    (actions.workplace.folder / "case.toml").write_text(CASE + "# by another editor\n")
    assert actions.state(known)["changed"] is True
    for command in ("check", "run"):
        with pytest.raises(CaseError, match="changed on the disk"):
            actions.command({"command": command, **known})
    (actions.workplace.folder / "case.toml").unlink()
    assert actions.state(known)["changed"] is False


def test_a_state_tells_what_a_run_has_left(actions):
    folder = actions.workplace.folder / "results/case"
    (folder / "checkpoint").mkdir(parents=True)
    run = actions.state({"results": "results/case"})["run"]
    assert run["checkpoint"] is True and run["report"] is False
    (folder / "checkpoint").rmdir()
    assert actions.state({"results": "results/case"})["run"]["checkpoint"] is False


@pytest.mark.parametrize("folder", ["../elsewhere", "/tmp/elsewhere"])
def test_a_run_whose_results_lie_outside_is_refused(actions, folder):
    text = CASE + f'[output]\nfolder = "{folder}"\n'
    (actions.workplace.folder / "case.toml").write_text(text)
    assert actions.open({"path": "case.toml"})["problems"] == []
    with pytest.raises(CaseError, match="outside"):
        actions.command({"command": "run", "path": "case.toml"})
    with pytest.raises(CaseError):
        actions.state({"results": folder})


def test_only_pages_and_pictures_are_shown(actions):
    (actions.workplace.folder / "report.html").write_text("")
    address = actions.show({"path": "report.html"})["address"]
    assert address.startswith("/show/")
    for path in ("case.toml", "missing.html", "../report.html"):
        with pytest.raises(CaseError):
            actions.show({"path": path})
