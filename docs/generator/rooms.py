"""The rooms of castx and what each offers, read from the source without importing it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

PROJECT = Path(__file__).parents[2]
_ROW = re.compile(r"^\| ((?:`\w+/`(?:, )?)+) \|", re.M)
_PUBLIC = re.compile(r"^Public:(.*?)(?:\n\s*\n|\Z)", re.M | re.S)


def rows() -> list[list[str]]:
    """Return the rooms that the rows of the tables of ARCHITECTURE.md name, row by row."""
    cells = _ROW.findall((PROJECT / "ARCHITECTURE.md").read_text())
    return [re.findall(r"\w+", cell) for cell in cells]


def rooms() -> list[str]:
    """Return all rooms in the order of ARCHITECTURE.md, each before the rooms inside it."""
    found = []
    for top in (room for row in rows() for room in row):
        inner = sorted((PROJECT / "castx" / top).rglob("__init__.py"))
        folders = [path.parent.relative_to(PROJECT / "castx").as_posix() for path in inner]
        found += sorted(folders)
    return found


def module_files(room: str) -> list[Path]:
    """Return the modules of a room."""
    return sorted((PROJECT / "castx" / room).glob("[!_]*.py"))


def introduction(path: Path) -> tuple[str, list[str]]:
    """Return the docstring of a room without its list of public objects, and this list.

    Args:
        path: folder of the room.
    """
    text = ast.get_docstring(ast.parse((path / "__init__.py").read_text())) or ""
    listed = _PUBLIC.search(text)
    if listed is None:
        return text, []
    return _PUBLIC.sub("", text).strip(), re.findall(r"`([\w.]+)`", listed[1])


def face() -> list[tuple[str, str, str]]:
    """Return the public objects of castx by name, their modules, and their names there."""
    tree = ast.parse((PROJECT / "castx" / "__init__.py").read_text())
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module]
    found = [
        (alias.asname or alias.name, str(node.module), alias.name)
        for node in imports
        for alias in node.names
    ]
    return sorted(item for item in found if item[1].count(".") > 1)


class Documented(NamedTuple):
    """A public object of a module.

    Attributes:
        name: in its module.
        kind: "class", "exception", "function" or "data".
        text: its docstring.
    """

    name: str
    kind: str
    text: str


def documented_objects(path: Path) -> Iterator[Documented]:
    """Yield the public classes, functions and explained constants of a module."""
    body = ast.parse(path.read_text()).body
    for node, following in zip(body, [*body[1:], None], strict=True):
        found = _documented(node, following)
        if found is not None and not found.name.startswith("_"):
            yield found


def _documented(node: ast.stmt, following: ast.stmt | None) -> Documented | None:
    if isinstance(node, ast.FunctionDef):
        return Documented(node.name, "function", ast.get_docstring(node) or "")
    if isinstance(node, ast.ClassDef):
        is_error = any("Error" in ast.unparse(base) for base in node.bases)
        kind = "exception" if is_error else "class"
        return Documented(node.name, kind, ast.get_docstring(node) or "")
    target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", None)
    text = getattr(getattr(following, "value", None), "value", None)
    if isinstance(target, ast.Name) and isinstance(following, ast.Expr) and isinstance(text, str):
        return Documented(target.id, "data", text)
    return None


def first_sentence(module: str, name: str) -> str:
    """Return the first line of the docstring of an object; empty if it has none."""
    path = PROJECT / f"{module.replace('.', '/')}.py"
    texts = [item.text for item in documented_objects(path) if item.name == name]
    return texts[0].partition("\n")[0] if texts else ""
