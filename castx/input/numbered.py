"""Declarations with numbers, such as "V3", by which they are asked for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Protocol, TypeVar

from castx.errors import CaseError
from castx.input.problems import among
from castx.input.registry import refuse_incomplete


class Numbered(Protocol):
    """A declaration with a number."""

    @property
    def number(self) -> str:
        """A letter and a number, such as "V3"."""


N = TypeVar("N", bound=Numbered)


def by_number(kind: str, declared: Iterable[N], needed: tuple[str, ...]) -> dict[str, N]:
    """Return declarations by their numbers, in the order in which they come.

    Args:
        kind: what they are, for messages.
        declared: the declarations.
        needed: names of attributes that must not be empty.

    Raises:
        TypeError: two have the same number, or one says too little.
    """
    found: dict[str, N] = {}
    for one in declared:
        what = f"{kind} {one.number}"
        refuse_incomplete(what, one, needed)
        if one.number in found:
            raise TypeError(f"{what} stands in two files")
        found[one.number] = one
    return found


def chosen_from(kind: str, known: Mapping[str, N], numbers: Sequence[str]) -> list[N]:
    """Return the declarations of some numbers in any spelling, or all of them if there are none.

    Args:
        kind: what they are, for messages.
        known: all of them by their numbers.
        numbers: that are asked for.

    Raises:
        CaseError: a number is not known.
    """
    wanted = {number.upper() for number in numbers}
    for number in numbers:
        if number.upper() not in known:
            raise CaseError(f"there is no {kind} {number!r}; {among(number, list(known))}")
    return [one for number, one in known.items() if not wanted or number in wanted]
