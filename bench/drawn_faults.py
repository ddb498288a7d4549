"""Draw small faults at random, over all constants, comparisons, signs and extremes of the physics.

    bin/with-fenicsx python3 bench/drawn_faults.py [NUMBER] [--seed SEED]

Prints the faults of a draw; `bench/mutation.py --draw` plants them and runs the tests.

A fault is one of these:

- a decimal number ten times or a tenth as large, 0.0 as 1.0;
- a whole number increased by one, from ten on ten times or a tenth as large; True for False;
- a comparison turned round, `<` into `>=` and `==` into `!=`. Equality of decimal numbers hardly
  ever happens, so that `<=` for `<` is drawn only where counts are compared;
- `+` for `-`, a sign left out, `and` for `or`, the largest for the smallest.

What no answer can depend on is left out: texts and what is computed for them, messages of errors
and of the log, annotations, `frozen` and `strict`, and `usual`, the values that tests draw.

Each candidate has a number that follows from the seed and from its line as it is written; the
lowest ones are drawn. So a change of other lines changes nothing about a fault that was drawn.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

CHECKOUT = Path(__file__).resolve().parent.parent
ROOMS = (
    "forms", "meshes", "castx/contact", "castx/equilibrium", "castx/transfer", "castx/mechanics",
    "castx/coupling", "castx/heat", "castx/foundry",
)  # fmt: skip
COMPARISONS: dict[type[ast.AST], tuple[str, str]] = {
    ast.Lt: ("<", ">="), ast.LtE: ("<=", ">"), ast.Gt: (">", "<="), ast.GtE: (">=", "<"),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="),
}  # fmt: skip
BOUNDARIES: dict[type[ast.AST], tuple[str, str]] = {
    ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">"),
}  # fmt: skip
COUNTED = ("size", "ndim", "rank", "count", "dim")
SIGNS: dict[type[ast.AST], tuple[str, str]] = {ast.Add: ("+", "-"), ast.Sub: ("-", "+")}
JOINTS: dict[type[ast.AST], tuple[str, str]] = {ast.And: ("and", "or"), ast.Or: ("or", "and")}
EXTREMES = {
    "min": "max", "max": "min", "minimum": "maximum", "maximum": "minimum", "fmin": "fmax",
    "fmax": "fmin", "argmin": "argmax", "argmax": "argmin",
}  # fmt: skip
LOGGED = ("debug", "info", "warning", "error", "exception", "warn")
WITHOUT_ANSWER = ("frozen", "strict", "usual")


class Fault(NamedTuple):
    """A fault at one place of a file.

    Attributes:
        path: of the file, relative to the checkout.
        line: on which it stands, from 1 on.
        start: first byte of what is replaced.
        end: first byte behind it.
        old: what is replaced.
        new: what stands there instead.
    """

    path: str
    line: int
    start: int
    end: int
    old: str
    new: str

    def __str__(self) -> str:
        """Say where it is and what it changes."""
        return f"{self.path}:{self.line}: {self.old}  →  {self.new}"

    def planted(self, code: str) -> str:
        """Return the code with the fault.

        Raises:
            ValueError: something else stands at its place.
        """
        data = code.encode()
        if data[self.start : self.end].decode() != self.old:
            raise ValueError(f"{self}: {data[self.start : self.end].decode()} stands there")
        return (data[: self.start] + self.new.encode() + data[self.end :]).decode()


class _Source:
    """Code of a file and the places of its nodes as bytes from its beginning."""

    def __init__(self, path: str, code: str) -> None:
        self.path, self.data = path, code.encode()
        self._lines = [0]
        for line in self.data.splitlines(keepends=True):
            self._lines.append(self._lines[-1] + len(line))

    def start(self, node: ast.expr) -> int:
        return self._lines[node.lineno - 1] + node.col_offset

    def end(self, node: ast.expr) -> int:
        assert node.end_lineno is not None and node.end_col_offset is not None
        return self._lines[node.end_lineno - 1] + node.end_col_offset

    def fault(self, start: int, old: str, new: str) -> Fault:
        line = self.data.count(b"\n", 0, start) + 1
        return Fault(self.path, line, start, start + len(old.encode()), old, new)

    def between(self, left: ast.expr, right: ast.expr, change: tuple[str, str]) -> Iterator[Fault]:
        """Yield the fault of an operator between two operands."""
        place = self.data.find(change[0].encode(), self.end(left), self.start(right))
        if place >= 0:
            yield self.fault(place, *change)


def other_numbers(value: complex | bool) -> tuple[str, ...]:
    """Return what stands for a number in its faults: ten times as much, a tenth.

    Of 0 it is 1, of a count below ten the next one, and the opposite of a truth.
    """
    if isinstance(value, bool):
        return (str(not value),)
    if isinstance(value, int):
        return (str(10 * value), str(value // 10)) if value >= 10 else (str(value + 1),)
    if isinstance(value, float):
        return (repr(10.0 * value), repr(value / 10.0)) if value else ("1.0",)
    return ()


def candidates(path: str, code: str) -> list[Fault]:
    """Return all faults of a file, in the order of their places."""
    source = _Source(path, code)
    found = {fault for node in _code(ast.parse(code)) for fault in _faults(source, node)}
    return sorted(found, key=lambda fault: (fault.start, fault.new))


def drawn(number: int, seed: int, checkout: Path = CHECKOUT) -> list[Fault]:
    """Return faults drawn from all rooms, each candidate as likely as any other."""
    every: list[tuple[str, Fault]] = []
    for file in (file for room in ROOMS for file in (checkout / room).rglob("*.py")):
        code = file.read_text(encoding="utf-8")
        found = candidates(file.relative_to(checkout).as_posix(), code)
        every += zip(_numbers(seed, found, code.splitlines()), found, strict=True)
    return [fault for _, fault in sorted(every)[:number]]


def _numbers(seed: int, faults: Sequence[Fault], lines: Sequence[str]) -> Iterator[str]:
    """Yield the numbers of the faults of a file, by which they are drawn."""
    times: Counter[tuple[str, str, str]] = Counter()
    for fault in faults:
        name = (lines[fault.line - 1].strip(), fault.old, fault.new)
        times[name] += 1
        yield sha256(repr((seed, fault.path, *name, times[name])).encode()).hexdigest()


def _code(node: ast.AST) -> Iterator[ast.AST]:
    """Yield what is computed for an answer, as the docstring of the file says."""
    if isinstance(node, ast.Raise | ast.Assert | ast.JoinedStr):
        return
    if isinstance(node, ast.keyword) and node.arg in WITHOUT_ANSWER:
        return
    if isinstance(node, ast.Call | ast.Subscript) and _is_said(node):
        return
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
        return
    if isinstance(node, ast.Assign) and "__all__" in ast.dump(node.targets[0]):
        return
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "type_params"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _code(child)


def _is_said(node: ast.Call | ast.Subscript) -> bool:
    """Return whether a node is a message of the log or a type of literals."""
    match node:
        case ast.Call(func=ast.Attribute(attr=name)):
            return name in LOGGED
        case ast.Subscript(value=ast.Name(id="Literal")):
            return True
    return False


def _is_count(node: ast.expr) -> bool:
    """Return whether a value is a count for certain: a length, a size, a whole number."""
    match node:
        case ast.Constant(value=value):
            return isinstance(value, int) and not isinstance(value, bool)
        case ast.Call(func=ast.Name(id="len")):
            return True
        case ast.Attribute(attr=name):
            return name in COUNTED
        case ast.Subscript(value=ast.Attribute(attr="shape")):
            return True
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() | ast.Mult(), right=right):
            return _is_count(left) and _is_count(right)
    return False


def _faults(source: _Source, node: ast.AST) -> Iterator[Fault]:
    """Yield the faults of one node."""
    match node:
        case ast.Constant(value=bool() | int() | float() as value):
            old = source.data[source.start(node) : source.end(node)].decode()
            for new in other_numbers(value):
                yield source.fault(source.start(node), old, new)
        case ast.Compare(left=left, ops=ops, comparators=others):
            for before, kind, after in zip([left, *others], ops, others, strict=False):
                if type(kind) in COMPARISONS:
                    yield from source.between(before, after, COMPARISONS[type(kind)])
                if type(kind) in BOUNDARIES and _is_count(before) and _is_count(after):
                    yield from source.between(before, after, BOUNDARIES[type(kind)])
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as kind, right=right):
            yield from source.between(left, right, SIGNS[type(kind)])
        case ast.BoolOp(op=kind, values=[first, second, *_]):
            yield from source.between(first, second, JOINTS[type(kind)])
        case ast.UnaryOp(op=ast.USub()):
            yield source.fault(source.start(node), "-", "")
        case ast.Call(func=ast.Name(id=name) as called) if name in EXTREMES:
            yield source.fault(source.start(called), name, EXTREMES[name])
        case ast.Call(func=ast.Attribute(attr=name) as called) if name in EXTREMES:
            yield source.fault(source.end(called) - len(name), name, EXTREMES[name])


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the faults of a draw."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("number", type=int, nargs="?", default=400)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args(arguments)
    print(*drawn(given.number, given.seed), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
