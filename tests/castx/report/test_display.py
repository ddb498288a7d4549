"""The X server for pictures: started when Xvfb is there, ended with the picture, else refused."""

from __future__ import annotations

import os

import pytest

from castx.errors import CaseError
from castx.report.display import display, start_server

pytestmark = pytest.mark.serial


def test_the_server_answers_and_ends_with_its_block(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":12345")
    started = []

    def noted(program):
        started.append(start_server(program))
        return started[-1]

    monkeypatch.setattr("castx.report.display.start_server", noted)
    with display():
        server, number = started[0]
        assert os.environ["DISPLAY"] == f":{number}" and server.poll() is None
        assert os.path.exists(f"/tmp/.X11-unix/X{number}")
    assert os.environ["DISPLAY"] == ":12345" and server.poll() is not None


def test_the_server_ends_when_drawing_fails(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(ZeroDivisionError), display():
        assert "DISPLAY" in os.environ
        raise ZeroDivisionError
    assert "DISPLAY" not in os.environ


def test_the_display_of_the_user_serves_where_there_is_no_server(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":7")
    monkeypatch.setattr("castx.report.display.shutil.which", lambda program: None)
    with display():
        assert os.environ["DISPLAY"] == ":7"


def test_no_display_and_no_server_is_refused(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr("castx.report.display.shutil.which", lambda program: None)
    with pytest.raises(CaseError, match="install Xvfb"), display():
        pass


def test_a_server_that_does_not_start_is_refused(monkeypatch):
    monkeypatch.setattr("castx.report.display.shutil.which", lambda program: "/bin/false")
    with pytest.raises(CaseError, match="does not start"), display():
        pass
