"""All cases of other programs: found by their files, in the order of their numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from castx.errors import CaseError
from castx.input.problems import among
from castx.input.registry import modules_of, refuse_incomplete
from castx.proof.foreign.declaration import ForeignCase

NEEDED = ("title", "program", "path", "exact", "remark")


def ordered(cases: Iterable[ForeignCase]) -> dict[str, ForeignCase]:
    """Return cases by their numbers.

    Raises:
        TypeError: two have the same number, or one says too little.
    """
    found: dict[str, ForeignCase] = {}
    for case in sorted(cases, key=lambda case: int(case.number[1:])):
        refuse_incomplete(f"foreign case {case.number}", case, NEEDED)
        if case.number in found:
            raise TypeError(f"foreign case {case.number} stands in two files")
        found[case.number] = case
    return found


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
    for number in numbers:
        if number.upper() not in FOREIGN_CASES:
            known = among(number, list(FOREIGN_CASES))
            raise CaseError(f"there is no foreign case {number!r}; {known}")
    wanted = {number.upper() for number in numbers}
    return [case for number, case in FOREIGN_CASES.items() if not wanted or number in wanted]
