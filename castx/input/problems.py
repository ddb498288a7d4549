"""Problems of a case file with their key path, and the message that shows them."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from castx.errors import CaseError
from castx.input.printable import printable

KeyPath = tuple[str | int, ...]

_LONGEST_VALUE = 80
_LONGEST_KEY = 64
_MOST_PROBLEMS = 30  # shown
_MOST_ENTRIES = 100  # looked at in one description
_BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")

_TEXTS = {
    "string_type": "a text in quotes is needed",
    "string_too_long": "at most {max_length} characters are allowed",
    "tuple_type": "a list is needed: [...], or [[...]] above each entry",
    "dict_type": "a table of keys is needed: {{ key = value, ... }}",
    "model_type": "a table of keys is needed: {{ key = value, ... }}",
    "too_short": "at least {min_length} needed, there are {actual_length}",
    "too_long": "at most {max_length} allowed",
    "missing": "missing; this key is needed",
    "invalid_key": "a text is needed as key",
}


@dataclass(frozen=True)
class Problem:
    """One reason to refuse a case.

    Args:
        path: keys and list indices that lead to the value.
        text: the mistake, what is allowed, and the cure.
    """

    path: KeyPath
    text: str


class Refusal(CaseError):
    """Problems found inside a description, with paths relative to it.

    Args:
        problems: at least one.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("; ".join(_line(problem, None) for problem in self.problems))

    def __reduce__(self) -> tuple[type[Refusal], tuple[Sequence[Problem]]]:
        return Refusal, (self.problems,)  # other ranks raise it too

    def inside(self, *path: str | int) -> Refusal:
        """Return the problems with paths from outside the value at `path`."""
        return Refusal(Problem(path + problem.path, problem.text) for problem in self.problems)


def refuse(text: str, *path: str | int) -> Refusal:
    """Return the refusal of a single value."""
    return Refusal([Problem(path, text)])


class RefusedFile(CaseError):
    """A case file that cannot be accepted, with all its problems.

    Args:
        source: the file, named at the start of the message.
        problems: with paths from the top of the file.
        data: content of the file, for the values.
    """

    def __init__(self, source: str, problems: Sequence[Problem], data: Any) -> None:
        self.problems = tuple(problems)
        self._given = source, self.problems, data
        super().__init__(summary(*self._given))

    def __reduce__(self) -> tuple[type[RefusedFile], tuple[str, Sequence[Problem], Any]]:
        return RefusedFile, self._given


def dotted(path: KeyPath) -> str:
    """Return a path in the form `bodies[1].material`, keys in quotes where TOML needs them."""
    parts = ""
    for key in path:
        if isinstance(key, int):
            parts += f"[{key}]"
        else:
            short = key if len(key) <= _LONGEST_KEY else f"{key[:_LONGEST_KEY]} ..."
            bare = short if _BARE_KEY.fullmatch(short) else _quoted(short)
            parts += f".{bare}" if parts else bare
    return parts


def _quoted(text: str) -> str:
    return printable(json.dumps(text, ensure_ascii=False))


def show(value: Any) -> str:
    """Return a value in the notation of a case file, shortened."""
    try:
        text = printable(json.dumps(value, ensure_ascii=False, default=str))
    except (ValueError, RecursionError):
        text = repr(value)
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 4] + " ..."


def among(name: str, known: Sequence[str], *, what: str = "known") -> str:
    """Return the known names and the nearest one, for the end of a message.

    Args:
        name: that is not known; "" for no guess.
        known: the names.
        what: word before them.
    """
    if not known:
        return f"{what}: none"
    known = [printable(entry) for entry in known]
    plain = {_letters(entry): entry for entry in known}
    near = get_close_matches(_letters(name), plain, n=1, cutoff=0.5)
    guess = f" (did you mean {show(plain[near[0]])}?)" if near else ""
    return f"{what}: {', '.join(known)}{guess}"


def _letters(name: str) -> str:
    """Return letters and digits of a name in lower case; what stands between them tells little."""
    return "".join(c for c in name.lower() if c.isalnum()) or name


def translate(error: ValidationError, known: Sequence[str]) -> Iterator[Problem]:
    """Yield the problems behind a pydantic error of one description.

    Args:
        error: raised by the description's own fields; inner descriptions appear as `Refusal`.
        known: the keys of the description.
    """
    for entry in error.errors(include_url=False)[:_MOST_ENTRIES]:
        yield from _translate_entry(entry, known)


def _translate_entry(entry: ErrorDetails, known: Sequence[str]) -> Iterator[Problem]:
    place = tuple(entry["loc"])
    context = entry.get("ctx", {})
    inner = context.get("error")
    if isinstance(inner, Refusal):
        yield from inner.inside(*place).problems
    elif isinstance(inner, CaseError):
        yield Problem(place, str(inner))
    elif entry["type"] == "extra_forbidden":
        yield Problem(place, f"unknown key; {among(str(place[-1]), known, what='known keys')}")
    else:
        text = _TEXTS.get(entry["type"])
        yield Problem(place, text.format(**context) if text else entry["msg"])


def summary(source: str, problems: Sequence[Problem], data: Any) -> str:
    """Return the message that shows all problems of a file with the values written there.

    Args:
        source: the file, named at the start.
        problems: with paths from the top of the file.
        data: content of the file, for the values.
    """
    lines = [_line(problem, data) for problem in problems[:_MOST_PROBLEMS]]
    if len(problems) == 1:
        return f"{source}: {lines[0]}"
    if len(problems) > _MOST_PROBLEMS:
        lines.append(f"... and {len(problems) - _MOST_PROBLEMS} more")
    return "\n  ".join([f"{source}: {len(problems)} problems", *lines])


def _line(problem: Problem, data: Any) -> str:
    """Return `path = value: text`, without a path or value that is missing."""
    where = dotted(problem.path)
    for key in problem.path:
        try:
            data = data[key]
        except (LookupError, TypeError):
            return f"{where}: {problem.text}"
    shown = where if isinstance(data, dict) or not where else f"{where} = {show(data)}"
    return f"{shown}: {problem.text}" if shown else problem.text
