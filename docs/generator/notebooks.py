"""Pages of the notebooks under demos/, with their pictures where they were executed.

A run of a notebook is kept in docs/_build/notebooks under a digest of all code and cases, so that
it is executed once for the tests and the site. With `--execute` those without a run are executed.
"""

from __future__ import annotations

import base64
import hashlib
import re
import sys
from pathlib import Path

import jupytext
import nbclient
import nbformat

PROJECT = Path(__file__).parents[2]
DEMOS = PROJECT / "demos"
PAGES = PROJECT / "docs" / "notebooks"
RUNS = PROJECT / "docs" / "_build" / "notebooks"
SECONDS = 580
"""Longest time that one cell may take."""

Notebook = nbformat.NotebookNode


def notebook_names() -> list[str]:
    """Return the file names of all notebooks."""
    return sorted(path.name for path in DEMOS.glob("*_notebook.py"))


def execute(name: str) -> Notebook:
    """Execute a notebook in the folder of the demos and keep its run.

    Args:
        name: file name under demos/.
    """
    notebook: Notebook = jupytext.read(DEMOS / name)
    place = {"metadata": {"path": str(DEMOS)}}
    nbclient.NotebookClient(
        notebook, timeout=SECONDS, kernel_name="python3", resources=place
    ).execute()
    stored = _stored_run(name)
    stored.parent.mkdir(parents=True, exist_ok=True)
    for old in stored.parent.glob(f"{Path(name).stem}-*.ipynb"):
        old.unlink()
    nbformat.write(notebook, stored)
    return notebook


def executed(name: str) -> Notebook:
    """Return the kept run of a notebook, or execute it when code or cases have changed since."""
    return kept(name) or execute(name)


def kept(name: str) -> Notebook | None:
    """Return the kept run of a notebook, None when code or cases have changed since."""
    stored = _stored_run(name)
    return nbformat.read(stored, as_version=4) if stored.exists() else None


def _stored_run(name: str) -> Path:
    digest = hashlib.sha256()
    for folder in ("castx", "forms", "meshes", "demos"):
        for path in sorted((PROJECT / folder).rglob("*")):
            if path.suffix in {".py", ".toml"}:
                digest.update(str(path.relative_to(PROJECT)).encode())
                digest.update(path.read_bytes())
    return RUNS / f"{Path(name).stem}-{digest.hexdigest()[:16]}.ipynb"


def page(notebook: Notebook, source: str, pictures: Path, stem: str, run: str = "executed") -> str:
    """Return a notebook as a page of Markdown; its pictures are written as files.

    Args:
        notebook: executed.
        source: path of its text in the project.
        pictures: folder for the pictures, beside the page.
        stem: beginning of their names.
        run: what was done with the notebook.
    """
    parts = []
    count = 0
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            image = output.get("data", {}).get("image/png")
            if image is not None:
                count += 1
                name = f"{stem}-{count}.png"
                (pictures / name).write_bytes(base64.b64decode(image))
                parts.append(f"![{_picture_text(notebook, count)}]({name})")
            elif output.get("name") == "stdout":
                parts.append(f"```text\n{output.text.rstrip()}\n```")
    parts.insert(1, f"*This page is `{source}`, {run}.*")
    return "\n\n".join(parts) + "\n"


def _picture_text(notebook: Notebook, count: int) -> str:
    title = re.sub(r"^# ", "", notebook.cells[0].source.splitlines()[0])
    return f"{title} Picture {count}"


def write_pages(execute_all: bool) -> None:
    """Write one page for each notebook, and the list of them.

    Args:
        execute_all: whether notebooks without a run are executed; otherwise their pages have the
            code alone.
    """
    PAGES.mkdir(exist_ok=True)
    stems = []
    for name in notebook_names():
        stem = name.removesuffix("_notebook.py")
        stems.append(stem)
        found = executed(name) if execute_all else kept(name)
        run = "executed" if found else "not executed; `bin/docs --notebooks` does it"
        notebook = found or jupytext.read(DEMOS / name)
        text = page(notebook, f"demos/{name}", PAGES, stem, run)
        (PAGES / f"{stem}.md").write_text(text)
    entries = "\n".join(stems)
    (PAGES / "index.md").write_text(
        "# Notebooks\n\nEach asks one question and answers it with runs, tables and pictures. The"
        " tests execute them\nand check their numbers.\n\n"
        f"```{{toctree}}\n:maxdepth: 1\n\n{entries}\n```\n"
    )


if __name__ == "__main__":
    write_pages("--execute" in sys.argv[1:])
