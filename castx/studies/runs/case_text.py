"""A case file with other values, as a study writes it for further use."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from castx.case.case import STUDIES
from castx.case.reading.read import case_data
from castx.input.overrides import apply_overrides
from castx.studies.runs.runner import Changes, changes_as_overrides


def changed_content(case_file: Path, overrides: Sequence[str], changes: Changes) -> dict[str, Any]:
    """Return the content of a case with other values, without its studies and results folder.

    Args:
        case_file: the case.
        overrides: values that replace those of the file.
        changes: further ones.

    Raises:
        CaseError: the file cannot be read, or a path leads nowhere.
    """
    content, _ = case_data(case_file, overrides)
    alone = {key: value for key, value in content.items() if key not in STUDIES}
    changed = apply_overrides(alone, changes_as_overrides(changes))
    if isinstance(changed.get("output"), dict):
        changed["output"].pop("folder", None)
    return changed
