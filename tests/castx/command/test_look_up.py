"""Tables of a database and of an entry, and the figure of one."""

from __future__ import annotations

import pytest
import typer

from castx.command.look_up import look_up

pytestmark = pytest.mark.serial


@pytest.fixture
def shown(comm, capsys):
    """Return a function that looks something up and returns what is shown and drawn."""
    command = typer.main.get_command(typer.Typer(callback=lambda: None))

    def run(name, plot):
        drawn = []
        context = typer.Context(command, obj=comm, info_name="materials")
        look_up(context, "the table", drawn.append, name, plot)
        return capsys.readouterr().out.splitlines(), drawn

    return run


def test_a_table_of_all(shown):
    assert shown(None, None) == (["the table"], [])


def test_an_entry_says_how_it_is_drawn(shown):
    lines = ["the table", "curves: castx materials steel --plot steel.png"]
    assert shown("steel", None) == (lines, [])


def test_an_entry_is_drawn(shown, tmp_path):
    path = tmp_path / "a.png"
    assert shown("steel", path) == (["the table", f"written: {path}"], [path])


def test_a_figure_needs_an_entry(shown, tmp_path):
    with pytest.raises(typer.BadParameter, match="castx materials NAME --plot FILE"):
        shown(None, tmp_path / "a.png")
