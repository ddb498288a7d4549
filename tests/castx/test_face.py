"""The public face of castx: its names, the examples in their docstrings, and who has to use it."""

from __future__ import annotations

import ast
import doctest
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import castx

pytestmark = pytest.mark.serial

DEMOS = Path(__file__).parents[2] / "demos"
OBJECTS = [name for name in castx.__all__ if not name.startswith("_")]
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def examples(name):
    """Return the example in the docstring of a public object."""
    found = getattr(castx, name)
    text = inspect.getdoc(found) or ""
    return doctest.DocTestParser().get_doctest(text, {}, f"castx.{name}", None, None)


@pytest.mark.parametrize("name", OBJECTS)
def test_the_example_of_each_object_is_true(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")
    (tmp_path / "cylinder.toml").write_bytes((DEMOS / "cylinder.toml").read_bytes())
    example = examples(name)
    assert example.examples, f"castx.{name} has no example in its docstring"
    said: list[str] = []
    doctest.DocTestRunner(verbose=False, optionflags=FLAGS).run(example, out=said.append)
    assert not said, "".join(said)


@pytest.mark.parametrize("page", ["README.md", "docs/manual/python.md"])
def test_python_in_the_documentation_runs(page, tmp_path, monkeypatch):
    """All blocks of a page, one after the other, on a coarse mesh and for a short time."""
    (tmp_path / "demos").symlink_to(DEMOS)
    text = (DEMOS.parent / page).read_text()
    monkeypatch.chdir(tmp_path)
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert any("castx.run" in block for block in blocks)
    code = "\n".join(blocks).replace('"time.end=20"', '"time.end=0.1", "geometry.size=1e-2"')
    exec(compile(code.replace("grids(20.0)", "grids(0.1)"), page, "exec"), {})


def test_importing_castx_imports_little_else_of_it():
    """Its version, and what keeps libraries from obeying the starting folder and taking signals."""
    code = "import sys, castx; print([m for m in sys.modules if m.startswith('castx.')])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "['castx.signals', 'castx.start_folder', 'castx.version']"


def test_names_are_listed_and_unknown_ones_refused():
    assert dir(castx) == sorted(castx.__all__)
    assert not hasattr(castx, "no_such_name")


def test_the_docstring_names_each_object():
    assert all(f"`{name}`" in (castx.__doc__ or "") for name in OBJECTS)


def test_editors_see_what_is_imported_lazily():
    """The names under TYPE_CHECKING are those that `__getattr__` finds, in the same modules."""
    tree = ast.parse(Path(castx.__file__).read_text())
    guarded = next(node for node in tree.body if isinstance(node, ast.If))
    seen = {
        alias.asname or alias.name: (node.module, alias.name)
        for node in guarded.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert sorted(seen) == sorted(OBJECTS)
    for name, (module, inside) in seen.items():
        assert getattr(castx, name) is getattr(sys.modules[str(module)], inside)


def imports(path: Path) -> list[str]:
    """Return the modules of castx and the names in them that a script imports."""
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            found += [f"{node.module}.{alias.name}" for alias in node.names]
    return [name for name in found if name.partition(".")[0] == "castx"]


@pytest.mark.parametrize("path", sorted(DEMOS.glob("*.py")), ids=lambda path: path.name)
def test_demos_use_the_public_face_alone(path):
    deeper = set(imports(path)) - {"castx", *(f"castx.{name}" for name in OBJECTS)}
    assert not deeper, f"{path.name} imports {sorted(deeper)}"
