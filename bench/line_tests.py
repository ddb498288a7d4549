"""Which tests may notice a fault in a line?

    bin/with-fenicsx python3 bench/line_tests.py PATH LINE

They are the tests that execute it, by the record of `bench/executed_lines.py`. A constant of a
module, a field of a class and a default of an argument take effect where they are used: for them it
is the tests that execute a function which names them, and those of the room, since registries name
nothing. Where nothing is recorded it is those of the room, too. Tests beside the path come first,
then those of the room, then the cheapest files.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(CHECKOUT))

from bench.executed_lines import FOLDER, RECORDED, ExecutedLines, read  # noqa: E402

Function = ast.FunctionDef | ast.AsyncFunctionDef


class LineTests:
    """The tests of lines.

    Args:
        executed: which tests execute which lines.
        checkout: folder of the code.
    """

    def __init__(self, executed: ExecutedLines, checkout: Path = CHECKOUT) -> None:
        self._executed = executed
        self._codes = {
            file.relative_to(checkout).as_posix(): file.read_text(encoding="utf-8")
            for room in RECORDED
            for file in sorted((checkout / room).rglob("*.py"))
        }
        self._functions = {
            path: [node for node in ast.walk(ast.parse(code)) if isinstance(node, Function)]
            for path, code in self._codes.items()
        }

    def __call__(self, path: str, line: int) -> list[str]:
        """Return the tests of a line, in the order in which they are to be tried."""
        found: set[str] = set()
        known = self._executed.knows(path, self._codes[path])
        if known:
            found = self._executed.tests_of(path, [line]) or self._executed.tests_of(
                path, _statement(ast.parse(self._codes[path]), line)
            )
        own, room = _beside(path)
        if not found:
            found = {test for test in self._executed.seconds if test.startswith((own, room))}
            found |= self._users(path, line) if known else set()
        return self._ordered(found, own, room)

    def _users(self, path: str, line: int) -> set[str]:
        """Return the tests of what is set up at a line when its module is imported."""
        for function in self._functions[path]:
            if function.lineno <= line < function.body[0].lineno:
                return self._executed.tests_of(path, _lines(function))
        names = set(_assigned(ast.parse(self._codes[path]), line))
        found: set[str] = set()
        for name in names:
            for other, function in self._naming(name):
                found |= self._executed.tests_of(other, _lines(function))
        if not found:
            for function in self._functions[path]:
                found |= self._executed.tests_of(path, _lines(function))
        return found

    def _naming(self, name: str) -> Iterator[tuple[str, Function]]:
        """Yield the functions that name something, with their files."""
        word = re.compile(rf"\b{re.escape(name)}\b")
        for path, code in self._codes.items():
            if word.search(code):
                lines = code.splitlines()
                for function in self._functions[path]:
                    if word.search("\n".join(lines[function.lineno - 1 : function.end_lineno])):
                        yield path, function

    def _ordered(self, tests: set[str], own: str, room: str) -> list[str]:
        """Order tests by files: the own one, the room's, the cheapest."""
        files: dict[str, list[str]] = {}
        for test in sorted(tests, key=lambda test: (self._executed.seconds[test], test)):
            files.setdefault(test.partition("::")[0], []).append(test)
        cost = {name: sum(self._executed.seconds[t] for t in files[name]) for name in files}
        order = sorted(files, key=lambda f: (f != own, not f.startswith(room), cost[f], f))
        return [test for file in order for test in files[file]]


def _beside(path: str) -> tuple[str, str]:
    """Return the file of tests beside a file of code, and the folder of tests of its room."""
    folder, _, name = path.rpartition("/")
    return f"tests/{folder}/test_{name}", f"tests/{folder}/"


def _lines(function: Function) -> range:
    """Return the lines of the body of a function."""
    return range(function.body[0].lineno, (function.end_lineno or function.lineno) + 1)


def _statement(module: ast.Module, line: int) -> range:
    """Return the lines of the innermost statement at a line; of a compound one its head."""
    found = range(line, line + 1)
    for node in ast.walk(module):  # outer statements come first
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or line):
            body = getattr(node, "body", None)
            last = body[0].lineno - 1 if body else node.end_lineno or line
            if line <= last and not isinstance(node, Function | ast.ClassDef):
                found = range(node.lineno, last + 1)
    return found


def _assigned(module: ast.Module, line: int) -> Iterator[str]:
    """Yield the names to which a statement of a module or a class assigns."""
    for node in ast.walk(module):
        if isinstance(node, ast.Assign | ast.AnnAssign):
            if node.lineno <= line <= (node.end_lineno or line):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                yield from (target.id for target in targets if isinstance(target, ast.Name))


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the tests of a line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("path", help="of a file, relative to the checkout")
    parser.add_argument("line", type=int)
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where lines are recorded")
    given = parser.parse_args(arguments)
    print(*LineTests(read(given.folder))(given.path, given.line), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
