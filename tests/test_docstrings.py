"""Docstrings name the arguments that there are, and begin with a sentence that can be read once."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

import pytest

from tests.test_architecture import LIBRARY, named

pytestmark = pytest.mark.serial

BLOCK = re.compile(r"^Args:\n((?:    .*\n?|\n)+)", re.M)
KNOT = re.compile(r"\b(?:that|those|what|whose|it)\b", re.I)
MOST_OF_THEM = 3
"""Pronouns in a first sentence above which it has to be read twice."""

PRONOUN = re.compile(
    r"^(?:(?:What|Which|That|Those|Whose)\b"
    r"|(?:Return|Yield|Give|Say|Tell)s? (?:what|which|those|them|it|how|that)\b"
    r"|\w+ what\b)"
)
"""Beginnings of sentences that tell of an object without its name."""

Documented = ast.ClassDef | ast.FunctionDef


def documented() -> Iterator[tuple[str, Documented, str]]:
    """Yield all classes and functions with a docstring, and where they stand."""
    for path in LIBRARY:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, Documented):
                text = ast.get_docstring(node)
                if text:
                    yield f"{named(path)}:{node.lineno} {node.name}", node, text


def arguments(node: Documented) -> list[str] | None:
    """Return the arguments of a function, or of a class by its `__init__`; None: it has none."""
    function: ast.stmt | None = node
    if isinstance(node, ast.ClassDef):
        found = [n for n in node.body if isinstance(n, ast.FunctionDef) and n.name == "__init__"]
        function = found[0] if found else None
    if not isinstance(function, ast.FunctionDef):
        return None
    given = function.args
    listed = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    listed += [extra for extra in (given.vararg, given.kwarg) if extra is not None]
    return sorted(item.arg for item in listed if item.arg not in ("self", "cls"))


def test_arguments_that_are_described_are_those_that_there_are():
    wrong = []
    for place, node, text in documented():
        block, wanted = BLOCK.search(text), arguments(node)
        if block is not None and wanted is not None:
            described = sorted(re.findall(r"^    (\w+):", block[1], re.M))
            if described != wanted:
                wrong.append(f"{place} describes {described}, has {wanted}")
    assert not wrong


def test_first_sentences_have_no_knots():
    first = ((place, text.split("\n\n")[0].replace("\n", " ")) for place, _, text in documented())
    assert not [line for line in first if len(KNOT.findall(line[1])) > MOST_OF_THEM]


def test_first_sentences_name_what_they_tell_of():
    nameless = [
        f"{place}: {text.splitlines()[0]}: name the object, by the term of the field"
        for place, _, text in documented()
        if PRONOUN.match(text)
    ]
    assert not nameless
