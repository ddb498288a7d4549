"""Pages of the interface of castx: one for each room, from the docstrings."""

from __future__ import annotations

import ast
from pathlib import Path

from docs.generator.docstrings import restructured
from docs.generator.rooms import (
    PROJECT,
    documented_objects,
    face,
    first_sentence,
    introduction,
    module_files,
    rooms,
)

PAGES = PROJECT / "docs" / "api"


def room_page(room: str) -> str:
    """Return the page of a room: what it holds, then its modules with their public objects."""
    text, public = introduction(PROJECT / "castx" / room)
    name = "castx." + room.replace("/", ".")
    parts = [_title(name, "="), restructured(text)]
    if public:
        parts += ["Public objects:", "\n".join(_public_item(name, listed) for listed in public)]
    parts += [_module_part(f"{name}.{path.stem}", path) for path in module_files(room)]
    return "\n\n".join(parts) + "\n"


def _public_item(room: str, listed: str) -> str:
    module, _, name = listed.rpartition(".")
    full = ".".join(part for part in (room, module) if part)
    return f"* :py:obj:`{listed} <{full}.{name}>`: {_sentence(full, name)}"


def _sentence(module: str, name: str) -> str:
    return restructured(first_sentence(module, name))


def _ground_page() -> str:
    paths = sorted((PROJECT / "castx").glob("[!_]*.py"))
    text, _ = introduction(PROJECT / "castx")
    rows = [
        f"* :py:obj:`castx.{name} <{module}.{inside}>`: {_sentence(module, inside)}"
        for name, module, inside in face()
    ]
    parts = [_title("castx", "="), restructured(text), "Public objects:", "\n".join(rows)]
    parts += [_module_part(f"castx.{path.stem}", path) for path in paths]
    return "\n\n".join(parts) + "\n"


def _module_part(module: str, path: Path) -> str:
    text = ast.get_docstring(ast.parse(path.read_text())) or ""
    parts = [_title(module, "-"), restructured(text)]
    for item in documented_objects(path):
        members = "\n   :members:" if item.kind == "class" else ""
        parts.append(f".. auto{item.kind}:: {module}.{item.name}{members}")
    return "\n\n".join(parts)


def _title(text: str, line: str) -> str:
    return f"{text}\n{line * len(text)}"


def write_pages() -> None:
    """Write the pages of all rooms and their list; files that stay the same are left alone.

    The search leaves them out: the manual answers in words what they answer in signatures.
    """
    PAGES.mkdir(exist_ok=True)
    pages = {"castx": _ground_page()}
    pages |= {room.replace("/", "."): room_page(room) for room in rooms()}
    rows = "\n".join(f"   {name.replace('.', '/')} <{name}>" for name in pages)
    pages["index"] = (
        f"{_title('Reference', '=')}\n\nThe rooms of castx from the ground up; each imports only"
        f" from rooms above it in this list.\n\n.. toctree::\n   :maxdepth: 1\n\n{rows}\n"
    )
    for name, found in pages.items():
        path, text = PAGES / f"{name}.rst", f":nosearch:\n\n{found}"
        if not path.exists() or path.read_text() != text:
            path.write_text(text)
    for path in PAGES.glob("*.rst"):
        if path.stem not in pages:
            path.unlink()
