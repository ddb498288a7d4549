"""The rooms of castx and what each offers, read from the source without importing it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

PROJECT = Path(__file__).parents[2]
_ROW = re.compile(r"^\| `([\w/]+)/` \|", re.M)
_PUBLIC = re.compile(r"^Public:(.*?)(?:\n\s*\n|\Z)", re.M | re.S)


def rooms() -> list[str]:
    """Return all rooms from the ground up, in the order of the table of ARCHITECTURE.md."""
    rows = _ROW.findall((PROJECT / "ARCHITECTURE.md").read_text())
    return [room for room in rows if room != "castx"]


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


def face() -> list[tuple[str, str]]:
    """Return the public objects of castx by name, with the modules that they come from."""
    tree = ast.parse((PROJECT / "castx" / "__init__.py").read_text())
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module]
    found = [(alias.name, str(node.module)) for node in imports for alias in node.names]
    return sorted((name, module) for name, module in found if module.count(".") > 1)


def documented_objects(path: Path) -> Iterator[tuple[str, ast.stmt]]:
    """Yield the public classes, functions and explained constants of a module, with their names."""
    body = ast.parse(path.read_text()).body
    for node, following in zip(body, [*body[1:], None], strict=True):
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            if not node.name.startswith("_"):
                yield node.name, node
        elif isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant):
            target = node.targets[0] if isinstance(node, ast.Assign) else node
            name = getattr(target, "id", getattr(getattr(target, "target", None), "id", "_"))
            if not name.startswith("_"):
                yield name, node
