"""Checks of the text of a case file: its problems with their lines, and what it describes."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from castx.app.text.toml_lines import line_of
from castx.case.case import STUDIES, Case
from castx.case.reading.read import read_case
from castx.errors import CaseError
from castx.input.problems import Refusal, RefusedFile, dotted
from castx.input.toml_text import parse_toml
from castx.studies.asked.reading import KINDS

_AT_LINE = re.compile(r"\(at line (\d+), column \d+\)")
_AT_END = "(at end of document)"


def checked(text: str, path: Path) -> dict[str, Any]:
    """Return problems and content of a case file, for JSON.

    Args:
        text: of the file.
        path: of the file; other files are relative to its folder.
    """
    try:
        data = parse_toml(text)
    except ValueError as error:  # of which CaseError is one
        found = _AT_LINE.search(str(error))
        line = int(found[1]) if found else None
        if _AT_END in str(error):
            line = len(text.splitlines())
        return {"problems": [{"line": line, "key": "", "text": f"not TOML: {error}"}], "case": None}
    problems = [problem for name in STUDIES if name in data for problem in _study(name, data, text)]
    case = None
    try:
        case = read_case({k: v for k, v in data.items() if k not in STUDIES}, path)
    except RefusedFile as refused:
        problems += [_problem(p.path, p.text, text) for p in refused.problems]
    except CaseError as error:
        problems.append({"line": None, "key": "", "text": str(error)})
    return {"problems": problems, "case": None if case is None else described(case)}


def _study(name: str, data: dict[str, Any], text: str) -> list[dict[str, Any]]:
    """Return the problems of a table on many runs."""
    try:
        KINDS[name].read(data[name])
    except Refusal as refused:
        return [_problem(p.path, p.text, text) for p in refused.inside(name).problems]
    return []


def _problem(path: tuple[str | int, ...], words: str, text: str) -> dict[str, Any]:
    return {"line": line_of(text, path), "key": dotted(path), "text": words}


def described(case: Case) -> dict[str, Any]:
    """Return the description of a case on the page, for JSON."""
    return {
        "name": case.name,
        "model": case.geometry.model,
        "cad": case.geometry.cad is not None,
        "bodies": [body.name for body in case.bodies],
        "end": float(case.time.end),
        "results": os.path.relpath(case.output.folder),
    }
