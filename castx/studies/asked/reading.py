"""The tables of studies in a case file, read beside the case itself."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from castx.case.case import STUDIES, Case
from castx.case.reading.read import case_data, load_case
from castx.errors import CaseError
from castx.input.problems import KeyPath, Problem, Refusal, summary
from castx.studies.asked.identify import Identify
from castx.studies.asked.known import with_known_ranges
from castx.studies.asked.optimise import Optimise
from castx.studies.asked.runner import Running
from castx.studies.asked.vary import Vary

KINDS: dict[str, type[Running]] = {"vary": Vary, "identify": Identify, "optimise": Optimise}
"""What describes each table."""
Study = TypeVar("Study", bound=Running)
log = logging.getLogger(__name__)


def read_study(path: Path, kind: type[Study], overrides: Sequence[str] = ()) -> Study:
    """Return a study of a case file.

    Args:
        path: the case file.
        kind: the description of the study.
        overrides: values that replace those of the file.

    Raises:
        CaseError: the file has no such table, it cannot be accepted, or no run has what it asks.
    """
    name = next(key for key, value in KINDS.items() if value is kind)
    data, remark = case_data(path, overrides)
    if name not in data:
        raise CaseError(f"{path} has no table [{name}], which says what the study is about")
    table = data[name]
    if kind is Vary and isinstance(table, dict) and isinstance(table.get("inputs"), list):
        inputs, words = with_known_ranges(table["inputs"], data)
        table = {**table, "inputs": inputs}
        for line in words:
            log.info("%s", line)
    source = f"{path} {remark}".strip()
    try:
        study = kind.read(table)
    except Refusal as refusal:
        raise CaseError(summary(source, _inside(name, refusal), data)) from None
    if isinstance(study, Vary) and study.number_of_runs < study.fewest_runs:
        log.warning(
            "%d runs are too few to tell %d inputs apart: that takes draws = %d at least",
            study.number_of_runs, len(study.inputs), study.fewest_runs,
        )  # fmt: skip
    if isinstance(study, Optimise):
        problems = list(_unanswerable(study, load_case(path, overrides)))
        if problems:
            raise CaseError(summary(source, problems, data))
    return study


def _unanswerable(study: Optimise, case: Case) -> Iterator[Problem]:
    """Yield the goal and the limits of a study that no run of its case can answer."""
    from castx.report.summary.answerable import refusal_of

    varied = [one.of for one in study.inputs]
    places: list[tuple[KeyPath, str]] = [(("optimise", "goal"), study.goal)]
    for index, limit in enumerate(study.limits):
        places.append((("optimise", "limits", index, "of"), limit.of))
    for place, name in places:
        if text := refusal_of(name, case, varied):
            yield Problem(place, text)


def _inside(name: str, refusal: Refusal) -> tuple[Problem, ...]:
    return refusal.inside(name).problems


def studies_of(path: Path, overrides: Sequence[str] = ()) -> dict[str, Running]:
    """Return the studies of a case file by the names of their tables.

    Raises:
        CaseError: one of them cannot be accepted.
    """
    data, _ = case_data(path, overrides)
    return {name: read_study(path, KINDS[name], overrides) for name in STUDIES if name in data}
