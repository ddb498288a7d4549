"""Formulas of a case file: arithmetic of named numbers, read without executing anything."""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.problems import among

LONGEST_FORMULA = 200
LARGEST = 1e300
CONSTANTS: Mapping[str, float] = {"pi": np.pi}
FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "abs": np.abs, "cos": np.cos, "exp": np.exp, "log": np.log, "max": np.maximum,
    "min": np.minimum, "sin": np.sin, "sqrt": np.sqrt, "tanh": np.tanh,
}  # fmt: skip
_ARGUMENTS = {"max": 2, "min": 2}
_OPERATORS: Mapping[type, Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: np.divide, ast.Pow: np.power, ast.UAdd: operator.pos, ast.USub: operator.neg,
}  # fmt: skip
_ALLOWED = f"numbers, pi, + - * / **, brackets and {', '.join(FUNCTIONS)}"


@dataclass(frozen=True)
class Formula:
    """Arithmetic of named numbers.

    Args:
        text: as a case file has it: "1e5 - 7e4*z".
        names: that it may use, each of which stands for an array of numbers.

    Raises:
        CaseError: it is no such arithmetic, or uses another name.
    """

    text: str
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        """Refuse a text that is no arithmetic."""
        _check(self._tree().body, self.names)

    @property
    def used(self) -> frozenset[str]:
        """The names that it does use."""
        found = {node.id for node in ast.walk(self._tree()) if isinstance(node, ast.Name)}
        return frozenset(found & set(self.names))

    def __call__(self, values: Mapping[str, FloatArray]) -> FloatArray:
        """Return the numbers of the formula, in the shape of the values of its names.

        They are not finite where the formula divides by zero or overflows.

        Args:
            values: by name, all of one shape.
        """
        with np.errstate(all="ignore"):
            found = _value(self._tree().body, values)
        return np.asarray(found + np.zeros_like(next(iter(values.values()))), dtype=np.float64)

    def _tree(self) -> ast.Expression:
        if not 0 < len(self.text) <= LONGEST_FORMULA:
            raise CaseError(f"a formula has 1 to {LONGEST_FORMULA} characters")
        try:
            return ast.parse(self.text.strip(), mode="eval")
        except (SyntaxError, ValueError, MemoryError, RecursionError):
            raise CaseError(f"{self.text!r} is no formula; it may have {_ALLOWED}") from None


def _check(node: ast.expr, names: Collection[str]) -> None:
    match node:
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            _check(left, names)
            _check(right, names)
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
            _check(operand, names)
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            if abs(value) > LARGEST:
                raise CaseError("a formula has a number that is too large")
        case ast.Name(id=name):
            known = [*names, *CONSTANTS]
            if name not in known:
                raise CaseError(f"{name!r} means nothing in a formula; {among(name, known)}")
        case ast.Call(func=ast.Name(id=name), args=given, keywords=[]) if name in FUNCTIONS:
            needed = _ARGUMENTS.get(name, 1)
            if len(given) != needed:
                raise CaseError(f"{name} of a formula needs {needed} arguments, got {len(given)}")
            for each in given:
                _check(each, names)
        case _:
            raise CaseError(f"a formula may have {_ALLOWED}")


def _value(node: ast.expr, values: Mapping[str, FloatArray]) -> Any:
    match node:
        case ast.Constant(value=value):
            return np.float64(value)
        case ast.Name(id=name):
            return values[name] if name in values else CONSTANTS[name]
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATORS[type(op)](_value(left, values), _value(right, values))
        case ast.UnaryOp(op=op, operand=operand):
            return _OPERATORS[type(op)](_value(operand, values))
        case ast.Call(func=ast.Name(id=name), args=given):
            return FUNCTIONS[name](*(_value(each, values) for each in given))
    raise AssertionError(ast.dump(node))
