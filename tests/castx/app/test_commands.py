"""Commands as processes: what they say, one at a time, their stop."""

import pytest

from castx.app.commands import Commands
from castx.errors import CaseError

pytestmark = pytest.mark.serial


def test_a_command_says_its_lines_and_its_exit_code(tmp_path):
    commands = Commands(tmp_path)
    first = commands.start(["check", "no such.toml"])
    with pytest.raises(CaseError, match="still runs"):
        commands.start(["--version"])
    assert first.wait(60)
    state = first.state()
    assert state["text"] == "castx check 'no such.toml'"
    assert state["ended"] and state["code"] == first.code == 2
    assert "no such.toml" in "".join(state["lines"]) and state["said"] == len(state["lines"])
    assert first.state(since=state["said"])["lines"] == []
    assert first.state(since=state["said"] - 1)["lines"] == state["lines"][-1:]
    first.stop()  # of what has ended is nothing


def test_a_command_that_is_killed_has_ended(tmp_path):
    command = Commands(tmp_path).start(["verify"])
    assert command.code is None
    command.kill()
    assert command.wait(60) and command.code == -9
