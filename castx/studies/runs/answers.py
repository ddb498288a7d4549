"""What a run has answered: the numbers of its report."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from castx.report.summary.freezing import STILL_LIQUID
from castx.report.summary.registry import findings
from castx.results.files.folder import write_whole
from castx.results.reading import Results

ANSWERS = "answers.json"


@dataclass(frozen=True)
class RunAnswer:
    """A number that a run has found.

    Attributes:
        name: what and of which body or interface, such as "Largest gap: casting/mould".
        value: in SI.
        unit: in which it is shown.
        factor: from SI to the unit.
    """

    name: str
    value: float
    unit: str
    factor: float

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
    if not kept.is_file():
        found = [
            (finding.name, finding.value, finding.unit, finding.factor)
            for finding in findings(Results(results))
            if finding.topic != STILL_LIQUID
        ]
        write_whole(kept, json.dumps(found, ensure_ascii=False) + "\n")
    rows: Sequence[tuple[str, float, str, float]] = json.loads(kept.read_text(encoding="utf-8"))
    return {row[0]: RunAnswer(*row) for row in rows}
