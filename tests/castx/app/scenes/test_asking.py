"""Scenes come from processes of their own, one of a sort at a time, with an end in words."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from castx.app.scenes import asking
from castx.app.scenes.asking import Scenes
from castx.errors import CaseError, MeshError
from castx.input.child_process import REFUSED

pytestmark = pytest.mark.serial


def instead(monkeypatch, script):
    """Let another script answer."""

    def run(arguments, patience, **_):
        command = [sys.executable, "-c", script, *arguments[2:]]
        return subprocess.run(command, capture_output=True, timeout=patience, check=False)

    monkeypatch.setattr(asking, "run_apart", run)


WRITE = "import sys; open(sys.argv[2], 'w').write({!r}); sys.exit({})"


def test_an_answer_is_passed_on_and_a_refusal_told(monkeypatch):
    instead(monkeypatch, WRITE.format('{"cells": 3}', 0))
    assert Scenes().mesh("", Path("case.toml")) == {"cells": 3}
    assert Scenes().moment(Path("results"), "gap") == {"cells": 3}
    instead(monkeypatch, WRITE.format("too small", REFUSED))
    with pytest.raises(MeshError, match="too small"):
        Scenes().mesh("", Path("case.toml"))


def test_a_process_that_dies_or_takes_too_long_has_a_cure(monkeypatch):
    instead(monkeypatch, "import os; os.kill(os.getpid(), 9)")
    with pytest.raises(MeshError, match=r"SIGKILL.*larger sizes"):
        Scenes().mesh("", Path("case.toml"))
    monkeypatch.setattr(asking, "PATIENCE", {"mesh": 0.2, "moment": 0.2})
    instead(monkeypatch, "import time; time.sleep(60)")
    with pytest.raises(MeshError, match="larger sizes"):
        Scenes().mesh("", Path("case.toml"))
    with pytest.raises(MeshError, match="report"):
        Scenes().moment(Path("results"), "gap")


def test_a_second_mesh_is_refused_as_long_as_the_first_one_is_made(monkeypatch):
    begun, go_on = threading.Event(), threading.Event()

    def answered(asked):
        begun.set()
        assert go_on.wait(10)
        return {}

    monkeypatch.setattr(asking, "answered", answered)
    scenes = Scenes()
    thread = threading.Thread(target=scenes.mesh, args=("", Path("case.toml")))
    thread.start()
    assert begun.wait(10)
    with pytest.raises(CaseError, match="still being made"):
        scenes.mesh("", Path("case.toml"))
    go_on.set()
    thread.join()
    assert scenes.moment(Path("results"), "gap") == {}
