"""All verifications: found by their files, in the order of their numbers."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from castx.input.numbered import by_number, chosen_from
from castx.input.registry import modules_of
from castx.proof.verification.verification import Verification

KIND = "verification"
NEEDED = ("title", "formula", "source", "levels", "quick")
ROOMS = ("heat", "solids", "contact", "coupled", "foundry")
"""Where the files are."""


def place_of(number: str) -> tuple[str, int]:
    """Return letter and number of a verification; exact solutions, V, before others."""
    letters, digits = re.fullmatch(r"([A-Z])(\d+)", number).groups()  # type: ignore[union-attr]
    return "" if letters == "V" else letters, int(digits)


def ordered(verifications: Iterable[Verification]) -> dict[str, Verification]:
    """Return verifications by their numbers.

    Raises:
        TypeError: two have the same number, or one says too little.
    """
    return by_number(KIND, sorted(verifications, key=lambda v: place_of(v.number)), NEEDED)


def _declared() -> Iterable[Verification]:
    for room in ROOMS:
        for module in modules_of(f"castx.proof.verification.{room}"):
            if hasattr(module, "VERIFICATION"):
                yield module.VERIFICATION


VERIFICATIONS: Mapping[str, Verification] = ordered(_declared())
"""All verifications by their numbers."""


def chosen(numbers: Sequence[str]) -> list[Verification]:
    """Return the verifications of some numbers, or all of them if there are none.

    Raises:
        CaseError: a number is not known.
    """
    return chosen_from(KIND, VERIFICATIONS, numbers)
