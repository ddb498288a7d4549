"""Values of the command line that replace those of the case file: `time.end=10`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from copy import deepcopy
from typing import Any

from castx.errors import CaseError
from castx.input.problems import among, dotted
from castx.input.toml_text import DEEPEST, TOO_DEEP, parse_toml

_SHOWN = 200  # characters
_INDEX = re.compile(r"\[(\d+)\]")


def apply_overrides(data: dict[str, Any], overrides: Sequence[str]) -> dict[str, Any]:
    """Return a copy of the content of a case file with values replaced or added.

    A list is entered by its index: `bodies.0.temperature=680` or `bodies[0].temperature=680`. The
    value is written as in the file; the quotes of a text may be left out: `time.end=5 min`.

    Raises:
        CaseError: not KEY=VALUE, or a path that leads nowhere.
    """
    result = deepcopy(data)
    for override in overrides:
        shown = shortened(override)
        path, equals, text = override.partition("=")
        keys = [key.strip() for key in _INDEX.sub(r".\1", path).split(".")]
        if not equals or not all(keys):
            raise CaseError(f"--set {shown}: KEY.PATH=VALUE is needed, such as time.end=10")
        if len(keys) > DEEPEST:
            raise CaseError(f"--set {shown}: {TOO_DEEP}")
        try:
            _replace(result, keys, _value(text.strip()))
        except CaseError as error:
            raise CaseError(f"--set {shown}: {error}") from None
    return result


def shortened(override: str) -> str:
    """Return a replacement as messages show it."""
    return override if len(override) <= _SHOWN else f"{override[:_SHOWN]} ..."


def value_at(data: Any, path: str) -> Any:
    """Return the value at a path of `apply_overrides`, None where there is none."""
    for key in _INDEX.sub(r".\1", path).split("."):
        if isinstance(data, dict) and key in data:
            data = data[key]
        elif isinstance(data, list) and key.isdecimal() and int(key) < len(data):
            data = data[int(key)]
        else:
            return None
    return data


def _value(text: str) -> Any:
    """Return a TOML value, or the text itself where it is none."""
    try:
        parsed = parse_toml(f"value = {text}")
    except ValueError:
        return text
    return parsed["value"] if len(parsed) == 1 else text


def _replace(data: Any, keys: Sequence[str], value: Any) -> None:
    for depth, key in enumerate(keys[:-1]):
        place = _place(data, key, keys[:depth])
        if isinstance(data, dict):
            data.setdefault(place, {})
        data = data[place]
    data[_place(data, keys[-1], keys[:-1])] = value


def _place(data: Any, key: str, above: Sequence[str]) -> str | int:
    """Return the key or index at which `key` is found in `data`."""
    where = dotted(tuple(above)) or "the case"
    if isinstance(data, dict):
        return key
    if not isinstance(data, list):
        raise CaseError(f"{where} is a single value and has no {key!r}")
    if key.isdecimal() and int(key) < len(data):
        return int(key)
    known = [str(index) for index in range(len(data))]
    raise CaseError(f"{where} is a list and has no {key!r}; {among(key, known, what='indices')}")
