"""Commands as processes: what they say, one at a time, their stop."""

import pytest

from castx.app.commands import Commands
from castx.errors import CaseError

pytestmark = pytest.mark.serial


def test_a_command_says_its_lines_and_its_exit_code(tmp_path):
    commands = Commands(tmp_path)
    first = commands.start(["check", "no such.toml"], 80)
    with pytest.raises(CaseError, match="still runs"):
        commands.start(["--version"], 80)
    assert first.wait(60)
    state = first.state()
    assert state["text"] == "castx check 'no such.toml'"
    assert state["ended"] and state["code"] == first.code == 2
    assert "no such.toml" in "".join(state["lines"]) and state["said"] == len(state["lines"])
    assert first.state(since=state["said"])["lines"] == []
    assert first.state(since=state["said"] - 1)["lines"] == state["lines"][-1:]
    first.stop()  # of what has ended is nothing


def test_lines_are_as_long_as_the_page_is_wide_within_bounds(tmp_path):
    commands, longest = Commands(tmp_path), []
    for columns in (0, 110):
        command = commands.start(["run", "--help"], columns)
        assert command.wait(60)
        longest.append(max(len(line) for line in command.state()["lines"]))
    assert longest[0] <= 60 < longest[1] <= 110


def test_a_command_that_is_killed_has_ended(tmp_path):
    command = Commands(tmp_path).start(["verify"], 80)
    assert command.code is None
    command.kill()
    assert command.wait(60) and command.code == -9
