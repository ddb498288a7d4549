"""All cases of other programs: found by their files, in the order of their numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from castx.input.numbered import by_number, chosen_from
from castx.input.registry import modules_of
from castx.proof.foreign.declaration import ForeignCase

KIND = "foreign case"
NEEDED = ("title", "program", "path", "exact", "remark")


def ordered(cases: Iterable[ForeignCase]) -> dict[str, ForeignCase]:
    """Return cases by their numbers.

    Raises:
        TypeError: two have the same number, or one says too little.
    """
    return by_number(KIND, sorted(cases, key=lambda case: int(case.number[1:])), NEEDED)


def _declared() -> Iterable[ForeignCase]:
    for module in modules_of("castx.proof.foreign.cases"):
        yield from module.CASES


FOREIGN_CASES: Mapping[str, ForeignCase] = ordered(_declared())
"""All cases by their numbers."""


def chosen(numbers: Sequence[str]) -> list[ForeignCase]:
    """Return the cases of some numbers, or all of them if there are none.

    Raises:
        CaseError: a number is not known.
    """
    return chosen_from(KIND, FOREIGN_CASES, numbers)
