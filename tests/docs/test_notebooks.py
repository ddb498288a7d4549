"""Pages of notebooks: text, code, what it printed, and pictures as files."""

import base64

import nbformat.v4 as nb
import pytest

from docs.generator import notebooks

pytestmark = pytest.mark.serial

PIXELS = b"\x89PNG pixels"


@pytest.fixture
def notebook():
    code = nb.new_code_cell("print(1)")
    code.outputs = [
        nb.new_output("stream", name="stdout", text="1\n"),
        nb.new_output("stream", name="stderr", text="noise"),
        nb.new_output("display_data", {"image/png": base64.b64encode(PIXELS).decode()}),
    ]
    return nb.new_notebook(cells=[nb.new_markdown_cell("# Why?\n\nText."), code])


def test_a_page_shows_what_the_notebook_did(notebook, tmp_path):
    page = notebooks.page(notebook, "demos/why_notebook.py", tmp_path, "why")
    assert page == (
        "# Why?\n\nText.\n\n*This page is `demos/why_notebook.py`, executed.*\n\n"
        "```python\nprint(1)\n```\n\n```text\n1\n```\n\n![Why? Picture 1](why-1.png)\n"
    )
    assert (tmp_path / "why-1.png").read_bytes() == PIXELS


def test_a_run_is_kept_until_the_code_changes(notebook, tmp_path, monkeypatch):
    for folder in ("castx", "forms", "meshes", "demos"):
        (tmp_path / folder).mkdir()
    (tmp_path / "demos" / "a_notebook.py").write_text("# %%\nprint(1)\n")
    monkeypatch.setattr(notebooks, "PROJECT", tmp_path)
    monkeypatch.setattr(notebooks, "DEMOS", tmp_path / "demos")
    monkeypatch.setattr(notebooks, "RUNS", tmp_path / "runs")
    executions = []

    class Client:
        def __init__(self, given, **settings):
            self.given = given

        def execute(self):
            executions.append(self.given)

    monkeypatch.setattr(notebooks.nbclient, "NotebookClient", Client)
    notebooks.executed("a_notebook.py")
    notebooks.executed("a_notebook.py")
    assert len(executions) == 1
    (tmp_path / "castx" / "law.py").write_text("changed = True\n")
    notebooks.executed("a_notebook.py")
    assert len(executions) == 2
    assert len(list((tmp_path / "runs").iterdir())) == 1


def test_pages_are_written_without_a_run_unless_one_is_asked_for(notebook, tmp_path, monkeypatch):
    monkeypatch.setattr(notebooks, "PAGES", tmp_path)
    monkeypatch.setattr(notebooks, "notebook_names", lambda: ["why_notebook.py"])
    monkeypatch.setattr(notebooks, "kept", lambda name: None)
    monkeypatch.setattr(notebooks, "execute", lambda name: notebook)
    source = nb.new_notebook(cells=[notebook.cells[0], nb.new_code_cell("print(1)")])
    monkeypatch.setattr(notebooks.jupytext, "read", lambda path: source)
    notebooks.write_pages(execute_all=False)
    text = (tmp_path / "why.md").read_text()
    assert "not executed; `bin/docs --notebooks`" in text and "print(1)" in text
    assert "```text" not in text
    notebooks.write_pages(execute_all=True)
    text = (tmp_path / "why.md").read_text()
    assert ", executed.*" in text and "```text\n1" in text
    assert "why" in (tmp_path / "index.md").read_text()
