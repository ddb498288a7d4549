"""What a run has answered: the numbers of its report."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter

from castx.report.summary.freezing import STILL_LIQUID
from castx.report.summary.registry import findings
from castx.results.files.folder import store_text
from castx.results.reading import Results

ANSWERS = "answers.json"
Row = tuple[str, float, str, float, bool]
_ROWS: TypeAdapter[list[Row]] = TypeAdapter(list[Row])


@dataclass(frozen=True)
class RunAnswer:
    """A number that a run has found.

    Attributes:
        name: what and of which body or interface, such as "Largest gap: casting/mould".
        value: in SI.
        unit: in which it is shown.
        factor: from SI to the unit.
        of_mesh: whether it tells of the mesh, and nothing of the casting.
    """

    name: str
    value: float
    unit: str
    factor: float
    of_mesh: bool = False

    @property
    def shown(self) -> float:
        """The number in its unit."""
        return self.factor * self.value


def answers(results: Path) -> dict[str, RunAnswer]:
    """Return all numbers that the report of a finished run has, by their names.

    They are read once and kept beside the results. A casting that has not frozen has no time.

    Args:
        results: the results folder.
    """
    kept = results.parent / ANSWERS
    rows = _kept_rows(kept)
    if rows is None:
        rows = [
            (finding.name, finding.value, finding.unit, finding.factor, finding.of_mesh)
            for finding in findings(Results(results))
            if finding.topic != STILL_LIQUID
        ]
        store_text(kept, json.dumps(rows, ensure_ascii=False) + "\n")
    return {row[0]: RunAnswer(*row) for row in rows}


def _kept_rows(kept: Path) -> list[Row] | None:
    """Return the rows of a file of answers; None where there is none, or it is damaged."""
    if not kept.is_file():  # nobody may ever write into a pipe
        return None
    try:
        return _ROWS.validate_json(kept.read_bytes(), strict=True)
    except (OSError, ValueError):
        return None
