"""The list of what is compared with exact solutions, from the tests in tests/verification."""

from __future__ import annotations

import ast
from pathlib import Path

from docs.generator.docstrings import restructured

PROJECT = Path(__file__).parents[2]
LIST = PROJECT / "docs" / "_build" / "verification.txt"


def entry(path: Path) -> str:
    """Return what a test compares, as an entry of a definition list."""
    text = ast.get_docstring(ast.parse(path.read_text())) or path.stem
    title, _, rest = text.partition("\n")
    lines = [*restructured(rest.strip()).splitlines(), "", f"``tests/verification/{path.name}``"]
    indented = "\n".join(f"    {line}" if line else "" for line in lines)
    return f"{restructured(title)}\n{indented}\n"


def write_list() -> None:
    """Write the list as reStructuredText; the page of the verification includes it."""
    LIST.parent.mkdir(parents=True, exist_ok=True)
    paths = sorted((PROJECT / "tests" / "verification").glob("test_*.py"))
    first = [path for path in paths if path.name.startswith("test_v")]
    rest = [path for path in paths if path not in first]
    LIST.write_text("\n".join(entry(path) for path in [*first, *rest]))
