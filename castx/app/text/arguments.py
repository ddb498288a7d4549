"""Values that the page sends, refused where they are not of their kind."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from castx.errors import CaseError

Asked = Mapping[str, Any]
LONGEST_NAME = 200


def text_of(asked: Asked, key: str) -> str:
    """Return a text.

    Raises:
        CaseError: there is none.
    """
    value = asked.get(key)
    if not isinstance(value, str):
        raise CaseError(f"the page has sent no text {key!r}")
    return value


def word_of(asked: Asked, key: str) -> str | None:
    """Return a short text that begins no option of a command; None: there is none, or it is empty.

    Raises:
        CaseError: it is no such text.
    """
    if asked.get(key) in (None, ""):
        return None
    value = text_of(asked, key)
    if len(value) > LONGEST_NAME or value.startswith("-") or not value.isprintable():
        raise CaseError(f"{key}: {value[:LONGEST_NAME]!r} cannot be given to a command")
    return value


def number_of(asked: Asked, key: str) -> int:
    """Return a whole number, 0 if there is none.

    Raises:
        CaseError: it is no number from 0 on.
    """
    value = asked.get(key, 0)
    if not isinstance(value, int) or isinstance(value, bool) or value < 0:
        raise CaseError(f"the page has sent no whole number {key!r}")
    return value
